#include "gateway/gateway.hpp"

#include <algorithm>
#include <utility>

#include "async/slept.hpp"
#include "async/spawn.hpp"
#include "gateway/axis/poller.hpp"
#include "gateway/journey/awaited_run.hpp"
#include "gateway/journey/search_watch.hpp"
#include "gateway/module/settings_guard.hpp"
#include "gateway/orphans.hpp"
#include "gateway/standing_stop.hpp"
#include "gateway/stop_all.hpp"

namespace tmcld {
namespace {

boost::asio::awaitable<void> stop_all_quietly(std::shared_ptr<Gateway> gateway) {
  co_await stop_all(std::move(gateway));
}

boost::asio::awaitable<void> stop_quietly(std::shared_ptr<Gateway> gateway,
                                          std::shared_ptr<GatewayAxis> axis, StopCause cause) {
  const StopInProgress in_progress(std::move(gateway));
  const auto stopped = co_await axis->stop(cause);
  if (!stopped) stop_until_it_stands(axis);
}

}  // namespace

tmcl::Result<tmcl::Link> open_configured_link(const BusConfig& config) {
  return tmcl::Link::open(config.link, config.link_options);
}

std::shared_ptr<Gateway> Gateway::create(const boost::asio::any_io_executor& executor,
                                         const Config& config, GatewayOptions options) {
  std::shared_ptr<Gateway> gateway(new Gateway(executor, std::move(options)));
  auto& audit = gateway->options_.audit;
  audit = kept_in(gateway->audit_memory_, gateway->clock_, std::move(audit));
  const auto& own = gateway->options_;
  gateway->deadmen_ = DeadmanMemory::open(own.deadmen, own.log);
  const auto stop = [weak = std::weak_ptr(gateway)](const std::shared_ptr<GatewayAxis>& axis) {
    if (const auto self = weak.lock()) self->begin_to_stop(axis, StopCause::lease_lost);
  };
  gateway->leases_ = std::make_shared<Leases>(executor, own.new_epoch, stop);
  if (!own.journal.empty()) {
    const auto held = [weak = std::weak_ptr(gateway)] {
      const auto self = weak.lock();
      return self ? self->holdings() : Holdings();
    };
    const auto tell = [weak = std::weak_ptr(gateway)](const std::string& why) {
      if (const auto self = weak.lock())
        self->tell({GatewayEvent::Kind::journal_failed, {}, {}, 0, why});
    };
    gateway->journal_ = std::make_shared<Journal>(executor, own.journal, held, own.log, tell);
  }
  gateway->access_ = config.access;
  gateway->path_ = config.path;
  gateway->moves_need_lease_ = config.daemon.moves_need_lease;
  gateway->planning.set_limit(config.daemon.planning_bytes());
  gateway->add_buses(config);
  gateway->add_axes(config);
  return gateway;
}

/// Those that it does not have yet, in the order of the configuration.
void Gateway::add_buses(const Config& config) {
  const auto tell = [weak = weak_from_this()](const GatewayEvent& event) {
    if (const auto self = weak.lock()) self->tell(event);
  };
  std::vector<std::shared_ptr<GatewayBus>> buses;
  for (const auto& bus : config.buses) {
    const auto known = std::ranges::find(buses_, bus.name, &GatewayBus::name);
    if (known != buses_.end()) {
      buses.push_back(*known);
      continue;
    }
    buses.push_back(std::make_shared<GatewayBus>(executor_, bus, options_.open_link, options_.log,
                                                 tell, arrivals_));
    buses.back()->keep({journal_, deadmen_, options_.audit});
    buses.back()->gate().on_search(
        [weak = weak_from_this(), of = buses.back().get()](tmcl::AxisAddress motor, Permit permit) {
          const auto self = weak.lock();
          if (auto axis = self ? self->find_axis(*of, motor) : nullptr) watch_search(axis, permit);
        });
    buses.back()->gate().on_setting(
        [weak = weak_from_this(), of = buses.back().get()](
            tmcl::AxisAddress motor, std::uint8_t parameter, std::optional<std::int32_t> value) {
          const auto self = weak.lock();
          const auto axis = self ? self->find_axis(*of, motor) : nullptr;
          const bool is_news = axis && axis->note_set_by_client(parameter, value);
          if (is_news && self->journal_) spawn(self->executor_, Journal::write(self->journal_));
        });
  }
  buses_ = std::move(buses);
}

/// The same; those without a configuration come behind.
void Gateway::add_axes(const Config& config) {
  std::vector<std::shared_ptr<GatewayAxis>> axes;
  for (const auto& axis : config.axes) {
    if (auto known = find_axis(axis.name)) {
      axes.push_back(std::move(known));
      continue;
    }
    const auto bus = std::ranges::find(buses_, axis.bus, &GatewayBus::name);
    axes.push_back(std::make_shared<GatewayAxis>(axis, *bus));
    axes.back()->module().note_configured();
  }
  const auto added = all_axes().subspan(configured_axes_);
  configured_axes_ = axes.size();
  axes.insert(axes.end(), added.begin(), added.end());
  axes_ = std::move(axes);
}

void Gateway::start() {
  guard_settings(shared_from_this());
  if (journal_) take_over_orphans();
  for (const auto& bus : buses_) bus->start();
  begin_to_watch_for_gaps();
}

void Gateway::begin_to_watch_for_gaps() {
  if (buses_.empty() || std::exchange(watches_for_gaps_, true)) return;
  spawn(executor_, watch_for_gaps(shared_from_this()));
}

std::vector<std::shared_ptr<GatewayBus>> Gateway::changed_by(const Config& config) const {
  std::vector<std::shared_ptr<GatewayBus>> changed;
  for (const auto& bus : buses_) {
    const auto next = std::ranges::find(config.buses, bus->name(), &BusConfig::name);
    if (next == config.buses.end() || next->said != bus->config().said) changed.push_back(bus);
  }
  return changed;
}

void Gateway::adopt(const Config& config, const std::string& words) {
  std::erase_if(retired_, [](const auto& bus) { return !bus->link().is_opening(); });
  const auto closed = changed_by(config);
  const auto is_closed = [&](const GatewayBus& bus) {
    return std::ranges::any_of(closed, [&](const auto& one) { return one.get() == &bus; });
  };
  const auto is_on_closed = [&](const auto& axis) { return is_closed(axis->bus()); };
  const auto before = axes_;
  configured_axes_ -= static_cast<std::size_t>(std::ranges::count_if(axes(), is_on_closed));
  std::erase_if(axes_, is_on_closed);
  std::erase_if(buses_, [&](const auto& bus) { return is_closed(*bus); });
  // It may be one on axes that are not there any more.
  if (!closed.empty()) planned_path.reset();
  for (const auto& bus : closed) bus->retire();
  retired_.insert(retired_.end(), closed.begin(), closed.end());
  access_ = config.access;
  path_ = config.path;
  moves_need_lease_ = config.daemon.moves_need_lease;
  planning.set_limit(config.daemon.planning_bytes());
  options_.on_exit = config.daemon.on_exit;
  const auto kept = buses_;
  add_buses(config);
  add_axes(config);
  for (const auto& bus : buses_)
    if (std::ranges::find(kept, bus) == kept.end()) bus->start();
  begin_to_watch_for_gaps();
  for (const auto& axis : before) {
    const auto next = find_axis(axis->name());
    if (next && next != axis) next->poller()->count_on_from(*axis->poller());
  }
  tell({GatewayEvent::Kind::configuration_loaded, {}, {}, 0, words});
}

// ---- what has to be put in order if the process ends --------------------------------------------

namespace {

/// Empty if no client holds it.
std::string why_held(const GatewayAxis& axis, const Leases& leases) {
  switch (axis.claim_kind()) {
    case ClaimKind::line: return "line";
    case ClaimKind::path: return "path";
    case ClaimKind::mint: return "mint";
    case ClaimKind::jog: return "jog";
    case ClaimKind::approach: return "approach";
    case ClaimKind::deadman_test: return "deadman test";
    case ClaimKind::verification: return "verification";
    case ClaimKind::tuning: return "tuning";
    case ClaimKind::stop: return "stop";
    case ClaimKind::none:
    case ClaimKind::settings:
    case ClaimKind::search: break;
  }
  if (axis.bus().gate().owes_stop(axis.address()) && axis.bus().motors().may_move(axis.address()))
    return "stop";
  const auto* lease = leases.of(axis);
  if (lease != nullptr && lease->terms.stops) return "lease";
  const bool has_owner = lease == nullptr && axis.holder().client != 0;
  return !axis.turns() ? "" : has_owner ? "turning" : "unattended";
}

}  // namespace

Holdings Gateway::holdings() const {
  Holdings holdings;
  for (const auto& axis : axes_) {
    auto why = why_held(*axis, *leases_);
    if (why.empty()) continue;
    holdings.push_back(
        {axis->bus().name(), axis->address(), std::move(why), axis->before(), last_seen(*axis)});
  }
  return holdings;
}

void Gateway::take_over_orphans() {
  auto left = Journal::read(options_.journal);
  if (!left) {
    log(LogLevel::error,
        "what another run of tmcld has left is not known, so axes that turn are "
        "stopped: " +
            left.error());
    for (const auto& bus : buses_) stop_what_turns(shared_from_this(), bus);
  }
  for (auto& holding : left.value_or(Holdings())) {
    const auto bus = std::ranges::find(buses_, holding.bus, &GatewayBus::name);
    auto axis = bus == buses_.end() ? nullptr : find_axis(**bus, holding.motor);
    if (!axis && bus != buses_.end()) axis = add_axis(*bus, holding.motor);
    if (axis) {
      take_over(axis, std::move(holding));
    } else {
      log(LogLevel::warning, "an axis that another run of tmcld led (" + holding.why +
                                 ") is on bus '" + holding.bus + "', which there is not any more");
    }
  }
  if (!buses_.empty()) spawn(buses_.front()->executor(), Journal::write(journal_));
}

boost::asio::awaitable<void> Gateway::end_journal() {
  if (!journal_) co_return;
  try {
    co_await Journal::write(journal_);
  } catch (...) {
    log_failure("the journal", std::current_exception());
  }
}

OnExit Gateway::on_exit() const { return options_.on_exit; }

Client Gateway::add_client(std::string name) {
  constexpr std::size_t most_names = 1000;
  const auto number = ++arrivals_->last_client;
  arrivals_->clients.emplace(number, name);
  if (client_names_.size() == most_names) client_names_.erase(client_names_.begin());
  client_names_.emplace(number, name);
  return {number, std::move(name)};
}

Client Gateway::rename_client(std::uint64_t number, std::string name) {
  arrivals_->clients.insert_or_assign(number, name);
  client_names_.insert_or_assign(number, name);
  return {number, std::move(name)};
}

std::string Gateway::name_of_client(std::uint64_t number) const {
  const auto there = arrivals_->clients.find(number);
  if (there != arrivals_->clients.end()) return there->second;
  const auto found = client_names_.find(number);
  return found == client_names_.end() ? "client " + std::to_string(number) : found->second;
}

namespace {

void tell_owner_lost(const GatewayAxis& axis, const std::string& owner) {
  axis.bus().audit("axis=" + axis.name() + " owner_lost owner=\"" + owner + "\": it is stopped");
  axis.bus().emit(event_of(
      axis, GatewayEvent::Kind::owner_lost,
      "axis '" + axis.name() + "' turned for " + owner + ", which has gone: it is stopped"));
}

}  // namespace

void Gateway::remove_client(std::uint64_t client) {
  arrivals_->clients.erase(client);
  std::vector<std::pair<std::shared_ptr<GatewayAxis>, std::string>> lost;
  for (const auto& axis : axes_) {
    const auto turning = axis->bus().motors().turning_of(axis->address());
    if (client == 0 || turning.client != client) continue;
    const auto* lease = leases_->of(*axis);
    if (lease == nullptr) begin_to_stop(axis, StopCause::lease_lost);
    if (lease == nullptr || lease->terms.stops) lost.emplace_back(axis, turning.name);
  }
  leases_->end_of(client);
  for (const auto& [axis, owner] : lost) tell_owner_lost(*axis, owner);
  for (const auto& bus : buses_) bus->end_reads_of_gone_clients();
}

bool Gateway::is_holding(std::uint64_t client) const {
  const auto is_its = [&](const auto& one) { return one.second.holder.number == client; };
  return std::ranges::any_of(leases_->all(), is_its) ||
         std::ranges::any_of(axes_, [&](const auto& axis) {
           return client != 0 && axis->bus().motors().turning_of(axis->address()).client == client;
         });
}

void Gateway::remove_all_clients() {
  const auto clients = arrivals_->clients;
  for (const auto& [client, name] : clients) remove_client(client);
}

void Gateway::begin_to_stop(const std::shared_ptr<GatewayAxis>& axis, StopCause cause) {
  try {
    spawn(axis->bus().executor(), stop_quietly(shared_from_this(), axis, cause));
  } catch (...) {
    stop_at_once();
    throw;
  }
}

void Gateway::revoke_movements() {
  arrivals_->stop_all();
  for (const auto& axis : axes_) axis->revoke_movements();
}

void Gateway::end_journeys() {
  for (const auto& axis : axes_) {
    if (!axis->is_on_journey()) continue;
    if (const auto journey = axis->journey()) {
      journey->end({tmcl::plan::DriveFault::Kind::asked, {}, "tmcld is ending"});
    } else {
      begin_to_stop(axis, StopCause::daemon);
    }
  }
}

/// What a client can no longer stop must not go on: it is stopped when its link is back.
void Gateway::stop_what_has_no_end(std::string_view bus) {
  for (const auto& axis : axes_) {
    const bool turns = axis->turns() && !axis->is_unattended();
    const bool has_no_end = turns || axis->claim_kind() == ClaimKind::search;
    if (axis->bus().name() == bus && has_no_end) begin_to_stop(axis, StopCause::daemon);
  }
}

bool Gateway::has_journeys() const {
  return std::ranges::any_of(axes_, [](const auto& axis) { return axis->is_on_journey(); });
}

void Gateway::stop_at_once() noexcept {
  arrivals_->stop_all();
  for (const auto& bus : buses_) bus->stop_at_once();
}

void Gateway::stop_in_need() {
  stop_at_once();
  stop_all_axes();
}

void Gateway::refuse_movements() noexcept {
  refuse_new_calls();
  for (const auto& bus : buses_) bus->refuse_movements();
}

void Gateway::stop_all_axes() {
  revoke_movements();
  if (!buses_.empty()) spawn(buses_.front()->executor(), stop_all_quietly(shared_from_this()));
}

boost::asio::awaitable<void> Gateway::watch_for_gaps(std::shared_ptr<Gateway> self) {
  auto& gaps = self->arrivals_->gaps;
  const auto executor = co_await boost::asio::this_coro::executor;
  while (!self->is_closed_) {
    gaps.look(self->clock_.now(), slept(executor));
    if (gaps.is_in_gap()) {
      co_await self->closed_.wait_for(Gaps::time_to_take_in);
      gaps.end(self->arrivals_->last);
      self->log_often("gap", LogLevel::warning, gap_text(gaps));
    }
    co_await self->closed_.wait_for(Gaps::look_interval);
  }
}

void Gateway::close() {
  refuse_new_calls();
  is_closed_ = true;
  closed_.notify();
  if (journal_) journal_->close();
  for (const auto& bus : buses_) bus->close();
}

void Gateway::join() {
  for (const auto& bus : buses_) bus->link().wait_for_opener();
  for (const auto& bus : retired_) bus->link().wait_for_opener();
  planner.join();
  if (journal_) journal_->join();
  deadmen_->join();
}

void Gateway::log_often(std::string_view cause, LogLevel level, std::string line) {
  auto limiter = limiters_.find(cause);
  if (limiter == limiters_.end()) limiter = limiters_.try_emplace(std::string(cause)).first;
  const auto admitted = limiter->second.admit(std::move(line), clock_.now());
  if (admitted) log(level, *admitted);
}

void Gateway::log_failure(std::string_view where, const std::exception_ptr& failure) {
  const LogSink often = [this](LogLevel level, std::string_view line) {
    log_often("failure", level, std::string(line));
  };
  tmcld::log_failure(often, where, failure);
}

GatewayBus* Gateway::find_bus(std::string_view name) const {
  const auto found = std::ranges::find(buses_, name, &GatewayBus::name);
  return found == buses_.end() ? nullptr : found->get();
}

std::shared_ptr<GatewayAxis> Gateway::find_axis(std::string_view name) const {
  const auto configured = axes();
  const auto found = std::ranges::find(configured, name, &GatewayAxis::name);
  return found == configured.end() ? nullptr : *found;
}

std::shared_ptr<GatewayAxis> Gateway::find_axis(const GatewayBus& bus,
                                                tmcl::AxisAddress address) const {
  const auto found = std::ranges::find_if(
      axes_, [&](const auto& axis) { return &axis->bus() == &bus && axis->address() == address; });
  return found == axes_.end() ? nullptr : *found;
}

std::shared_ptr<GatewayAxis> Gateway::add_axis(std::shared_ptr<GatewayBus> bus,
                                               tmcl::AxisAddress address) {
  if (axes_.size() - configured_axes_ >= most_added_axes) return nullptr;
  AxisConfig config{raw_name(*bus, address), bus->name(), address};
  config.scale.full_steps = options_.full_steps;
  return axes_.emplace_back(std::make_shared<GatewayAxis>(std::move(config), std::move(bus)));
}

std::string Gateway::raw_name(const GatewayBus& bus, tmcl::AxisAddress address) const {
  const auto name = std::to_string(number(address.module)) + "/" + std::to_string(address.motor);
  return buses_.size() == 1 ? name : bus.name() + ":" + name;
}

std::uint64_t Gateway::on_event(OnGatewayEvent listener) {
  listeners_.emplace(++last_listener_, std::move(listener));
  return last_listener_;
}

void Gateway::tell(const GatewayEvent& event) {
  if (event.kind == GatewayEvent::Kind::link_lost) stop_what_has_no_end(event.bus);
  for (const auto& [id, listener] : listeners_) listener(event);
}

}  // namespace tmcld

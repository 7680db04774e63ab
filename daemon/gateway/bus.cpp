#include "gateway/bus.hpp"

#include <algorithm>
#include <utility>

#include <unistd.h>

#include "async/gather.hpp"
#include "async/spawn.hpp"
#include "gateway/axis/raw_command.hpp"

namespace tmcld {
namespace {

using namespace std::chrono_literals;
using boost::asio::awaitable;

constexpr tmcl::Duration shortest_retry = 100ms;
constexpr tmcl::Duration longest_retry = 1s;
// A link that lived so long was no flicker: the next retry is quick again.
constexpr tmcl::Duration stable_after = 2s;
// How often silent modules are asked whether they are back: a question to one that is not takes
// some 100 ms of a serial line.
constexpr tmcl::Duration module_check_interval = 2s;
constexpr std::string_view why_retired = "the configuration of this bus has changed";

awaitable<void> feed(std::shared_ptr<GatewayBus> bus, GatewayModule& module,
                     tmcl::TimePoint deadline) {
  co_await module.feed(deadline);
  bus->look_at_feeding();
}

std::string names_of_moving(const Motors& motors) {
  std::string names;
  for (const auto& axis : motors.under_way())
    names += (names.empty() ? "; axes that may move: '" : ", '") + axis + "'";
  return names;
}

}  // namespace

GatewayBus::GatewayBus(const boost::asio::any_io_executor& executor, BusConfig config,
                       OpenLink open_link, LogSink log, OnGatewayEvent on_event,
                       std::shared_ptr<Arrivals> arrivals)
    : executor_(executor),
      config_(std::move(config)),
      log_(std::move(log)),
      on_event_(std::move(on_event)),
      clock_(executor),
      changed_(executor),
      link_(executor, config_, std::move(open_link)),
      feeding_(executor),
      gate_(*this, config_.name, std::move(arrivals)) {}

void GatewayBus::start() {
  spawn(executor_, serve(shared_from_this()));
  spawn(executor_, feed_modules(shared_from_this()));
}

void GatewayBus::close() {
  closed_ = true;
  if (line()) line()->close();
  changed_.notify();
  feeding_.notify();
}

void GatewayBus::stop_at_once() const noexcept {
  if (!line()) return;
  motors().for_each([this](tmcl::AxisAddress motor) { line()->stop_at_once(motor); });
}

void GatewayBus::end_reads_of_gone_clients() const noexcept {
  try {
    if (line()) line()->end_unwanted_reads();
  } catch (...) {  // without memory for that they end when their turn comes
  }
}

void GatewayBus::retire() {
  retired_ = true;
  emit({GatewayEvent::Kind::link_lost, config_.name, {}, 0, std::string(why_retired)});
  close();
}

// ---- opening, losing, opening again ------------------------------------------------------------

awaitable<void> GatewayBus::serve(std::shared_ptr<GatewayBus> self) {
  auto retry = shortest_retry;
  while (!self->closed_) {
    if (!self->line() && !co_await self->open()) {
      co_await self->rest(retry);
      retry = std::min(2 * retry, longest_retry);
      continue;
    }
    const auto opened = self->clock_.now();
    co_await self->look_after_modules();
    self->detach();
    retry = self->clock_.now() - opened >= stable_after ? shortest_retry
                                                        : std::min(2 * retry, longest_retry);
    co_await self->rest(retry);
  }
}

awaitable<void> GatewayBus::rest(tmcl::Duration duration) {
  const auto until = clock_.now() + duration;
  while (!closed_ && clock_.now() < until) co_await changed_.wait_until(until);
}

tmcl::Result<void> GatewayBus::open_now() {
  auto link = link_.open_now();
  if (!link) return tl::unexpected(std::move(link.error()));
  attach(std::move(*link));
  return {};
}

awaitable<bool> GatewayBus::open() {
  auto link = co_await link_.open();
  if (closed_) co_return false;
  if (!link) {
    auto why = link.error().message + (link.error().hint.empty() ? "" : "; " + link.error().hint);
    if (link_.note_error(std::move(why)))
      log(LogLevel::warning, config_.name + ": cannot be opened: " + link_.error());
    co_return false;
  }
  attach(std::move(*link));
  co_return true;
}

void GatewayBus::log(LogLevel level, const std::string& line) {
  if (const auto admitted = log_limiter_.admit(line, clock_.now())) log_(level, *admitted);
}

void GatewayBus::audit(std::string line) const {
  if (records_.audit)
    records_.audit({::geteuid(), ::getpid(), "bus=" + name() + " " + std::move(line)});
}

void GatewayBus::attach(tmcl::Link link) {
  // The handler dies with the bus, which does not outlive this object by more than its verbs do.
  auto on_event = [weak = weak_from_this()](const tmcl::BusEvent& event) {
    if (const auto self = weak.lock()) self->on_bus_event(event);
  };
  const bool again = link_.attach(std::move(link), std::move(on_event));
  gate_.send_owed_stops();
  if (again) {
    emit({GatewayEvent::Kind::link_restored, config_.name, {}, 0, to_string(config_.link)});
  } else {
    log(LogLevel::info, config_.name + ": open on " + to_string(config_.link));
  }
}

void GatewayBus::detach() {
  link_.detach();
  gate_.note_lost_link();
  for (auto& [address, module] : modules_) module->forget_state();
}

awaitable<void> GatewayBus::look_after_modules() {
  const auto bus = line();
  while (!closed_ && bus->is_open()) {
    // A module that does not answer keeps a serial line busy: no axis on a path can wait for that.
    std::vector<awaitable<tmcl::Result<void>>> questions;
    for (auto& [address, module] : modules_) {
      if (has_paths() || module->state() == GatewayModule::State::ready) continue;
      if (!module->is_configured() && !gate_.owes_stop(address)) continue;
      questions.push_back(module->be_ready());
    }
    if (!questions.empty()) co_await gather(std::move(questions));
    if (closed_ || !bus->is_open()) break;
    co_await changed_.wait_for(module_check_interval);
  }
}

/// As long as this runs, the modules hear of it: when it hangs or ends, they stop their motors.
awaitable<void> GatewayBus::feed_modules(std::shared_ptr<GatewayBus> self) {
  while (!self->closed_) {
    auto next = tmcl::TimePoint::max();
    for (auto& [address, module] : self->modules_) {
      const auto now = self->clock_.now();
      const bool is_due = module->feeding_due() <= now;
      if (is_due) spawn(self->executor_, feed(self, *module, module->deadman().begin_to_feed(now)));
      if (!is_due) next = std::min(next, module->feeding_due());
    }
    co_await self->feeding_.wait_until(next);
  }
}

void GatewayBus::on_bus_event(const tmcl::BusEvent& event) {
  using Kind = GatewayEvent::Kind;
  switch (event.kind) {
    case tmcl::BusEvent::Kind::target_reached:
      return emit({Kind::target_reached, config_.name, number(event.module), event.value, {}});
    case tmcl::BusEvent::Kind::duplicate_address:
      if (auto* module = find_module(event.module)) module->note_duplicate();
      return emit({Kind::duplicate_address, config_.name, number(event.module), 0, event.text});
    case tmcl::BusEvent::Kind::link_condition:
      return emit({Kind::link_condition, config_.name, {}, 0, event.text});
    case tmcl::BusEvent::Kind::link_lost:
      link_.note_error(event.text);
      changed_.notify();
      if (closed_) return;
      return emit({Kind::link_lost, config_.name, {}, 0, event.text + names_of_moving(motors())});
  }
}

void GatewayBus::emit(GatewayEvent event) {
  const bool good = event.kind == GatewayEvent::Kind::target_reached ||
                    event.kind == GatewayEvent::Kind::link_restored ||
                    event.kind == GatewayEvent::Kind::axis_stopped ||
                    event.kind == GatewayEvent::Kind::module_answers;
  auto line = event.bus + ": " + std::string(name_of(event.kind));
  if (event.address) line += " (module " + std::to_string(*event.address) + ")";
  if (!event.text.empty()) line += ": " + event.text;
  log(good ? LogLevel::info : LogLevel::warning, line);
  if (on_event_) on_event_(event);
}

std::string_view name_of(GatewayEvent::Kind kind) {
  switch (kind) {
    case GatewayEvent::Kind::target_reached: return "target_reached";
    case GatewayEvent::Kind::duplicate_address: return "duplicate_address";
    case GatewayEvent::Kind::link_condition: return "link_condition";
    case GatewayEvent::Kind::link_lost: return "link_lost";
    case GatewayEvent::Kind::link_restored: return "link_restored";
    case GatewayEvent::Kind::line_broken: return "line_broken";
    case GatewayEvent::Kind::path_broken: return "path_broken";
    case GatewayEvent::Kind::mint_broken: return "mint_broken";
    case GatewayEvent::Kind::jog_broken: return "jog_broken";
    case GatewayEvent::Kind::approach_broken: return "approach_broken";
    case GatewayEvent::Kind::lease_lost: return "lease_lost";
    case GatewayEvent::Kind::owner_lost: return "owner_lost";
    case GatewayEvent::Kind::journal_failed: return "journal_failed";
    case GatewayEvent::Kind::axis_stopped: return "axis_stopped";
    case GatewayEvent::Kind::axis_fault: return "axis_fault";
    case GatewayEvent::Kind::orphan_stopped: return "orphan_stopped";
    case GatewayEvent::Kind::module_silent: return "module_silent";
    case GatewayEvent::Kind::module_answers: return "module_answers";
    case GatewayEvent::Kind::module_in_bootloader: return "module_in_bootloader";
    case GatewayEvent::Kind::module_reset: return "module_reset";
    case GatewayEvent::Kind::module_replaced: return "module_replaced";
    case GatewayEvent::Kind::settings_drift: return "settings_drift";
    case GatewayEvent::Kind::configuration_loaded: return "configuration_loaded";
  }
  return {};
}

// ---- modules -----------------------------------------------------------------------------------

GatewayModule* GatewayBus::find_module(tmcl::ModuleAddress address) const {
  const auto found = modules_.find(address);
  return found == modules_.end() ? nullptr : found->second.get();
}

const tmcl::Model* GatewayBus::model_of(tmcl::ModuleAddress address) const {
  const auto* module = find_module(address);
  return module == nullptr ? nullptr : module->model();
}

GatewayModule& GatewayBus::add_module(tmcl::ModuleAddress address) {
  auto& module = modules_[address];
  if (module) return *module;
  const auto configured = std::ranges::find(config_.modules, address, &ModuleConfig::address);
  const bool is_told = configured != config_.modules.end();
  module = std::make_unique<GatewayModule>(*this, is_told ? *configured : ModuleConfig{address});
  return *module;
}

// ---- calls -------------------------------------------------------------------------------------

tmcl::Error GatewayBus::not_open() const {
  auto error = tmcl::not_sent(
      tmcl::Errc::link_lost,
      retired_  ? std::string(why_retired)
      : closed_ ? "the daemon is ending"
                : "the bus is not open" + (link_.error().empty() ? "" : ": " + link_.error()),
      closed_ ? "" : "it is opened again as soon as that is possible; check cable and power");
  error.bus = config_.name;
  return error;
}

awaitable<tmcl::Result<tmcl::Answer>> GatewayBus::execute(tmcl::Request request,
                                                          RunOptions options) {
  if (!line()) {
    auto error = not_open();
    error.request = request;
    if (is_stop(intent_of(request)) && gate_.owe(request)) error.hint = owed_stop_hint;
    co_return tl::unexpected(std::move(error));
  }
  auto* module = find_module(request.address);
  const bool asks = effect_of(request.command, request.type) == tmcl::Effect::reads;
  // What is read or checked while it is on its way may be from before it.
  if (module != nullptr && !asks) module->note_settings_changed();
  options.announced = request;
  options.permit.needs_no_reference = is_relative_move(request);
  auto script =
      is_relative_move(request) ? move_relatively(request, {}) : tmcl::verbs::command(request);
  auto answer = co_await run(std::move(script), std::move(options));
  if (module == nullptr) co_return answer;
  if (!answer) module->note(answer.error());
  if (!asks) module->note_settings_changed();
  co_return answer;
}

}  // namespace tmcld

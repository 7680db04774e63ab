#include "gateway/bus.hpp"

#include <algorithm>
#include <utility>

#include "async/gather.hpp"
#include "async/spawn.hpp"
#include "gateway/axis_limits.hpp"
#include "tmcl/relative_move.hpp"

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

tmcl::BusCounters sum(tmcl::BusCounters a, const tmcl::BusCounters& b) {
  a.requests += b.requests;
  a.replies += b.replies;
  a.timeouts += b.timeouts;
  a.late_replies += b.late_replies;
  a.unexpected_replies += b.unexpected_replies;
  a.garbage_bytes += b.garbage_bytes;
  a.fences += b.fences;
  a.surplus += b.surplus;
  a.suspect += b.suspect;
  return a;
}

}  // namespace

std::string_view name_of(GatewayBus::State state) {
  switch (state) {
    case GatewayBus::State::opening: return "opening";
    case GatewayBus::State::open: return "open";
    case GatewayBus::State::lost: return "lost";
  }
  return {};
}

GatewayBus::GatewayBus(const boost::asio::any_io_executor& executor, BusConfig config,
                       OpenLink open_link, LogSink log, OnGatewayEvent on_event,
                       std::shared_ptr<Arrivals> arrivals)
    : executor_(executor),
      config_(std::move(config)),
      open_link_(std::move(open_link)),
      log_(std::move(log)),
      on_event_(std::move(on_event)),
      clock_(executor),
      changed_(executor),
      motors_(config_.name, std::move(arrivals)) {}

void GatewayBus::start() { spawn(executor_, serve(shared_from_this())); }

void GatewayBus::close() {
  closed_ = true;
  if (bus_) bus_->close();
  changed_.notify();
}

tmcl::BusCounters GatewayBus::counters() const {
  return bus_ ? sum(earlier_counters_, bus_->counters()) : earlier_counters_;
}

// ---- opening, losing, opening again ------------------------------------------------------------

awaitable<void> GatewayBus::serve(std::shared_ptr<GatewayBus> self) {
  auto retry = shortest_retry;
  while (!self->closed_) {
    if (!self->bus_ && !co_await self->open()) {
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
  auto link = open_link_(config_);
  if (!link) return tl::unexpected(std::move(link.error()));
  attach(std::move(*link));
  return {};
}

awaitable<bool> GatewayBus::open() {
  opening_link_ = true;
  auto work = [open = open_link_, config = config_] { return open(config); };
  auto link = co_await elsewhere(opener_, std::move(work));
  opening_link_ = false;
  if (closed_) co_return false;
  if (!link) {
    report_failure(link.error());
    co_return false;
  }
  attach(std::move(*link));
  co_return true;
}

void GatewayBus::report_failure(const tmcl::Error& error) {
  auto why = error.message + (error.hint.empty() ? "" : "; " + error.hint);
  if (why == error_) return;
  error_ = std::move(why);
  log(LogLevel::warning, config_.name + ": cannot be opened: " + error_);
}

void GatewayBus::log(LogLevel level, const std::string& line) {
  if (const auto admitted = log_limiter_.admit(line, clock_.now())) log_(level, *admitted);
}

void GatewayBus::attach(tmcl::Link link) {
  const bool again = state_ == State::lost;
  bus_ = std::make_shared<tmcl::Bus>(executor_, std::move(link), config_.bus_options);
  // The handler dies with the bus, which does not outlive this object by more than its verbs do.
  bus_->on_event([weak = weak_from_this()](const tmcl::BusEvent& event) {
    if (const auto self = weak.lock()) self->on_bus_event(event);
  });
  state_ = State::open;
  error_.clear();
  if (again) {
    emit({GatewayEvent::Kind::link_restored, config_.name, {}, 0, to_string(config_.link)});
  } else {
    log(LogLevel::info, config_.name + ": open on " + to_string(config_.link));
  }
}

void GatewayBus::detach() {
  earlier_counters_ = sum(earlier_counters_, bus_->counters());
  bus_->on_event({});
  bus_.reset();
  state_ = State::lost;
  ++commands_;
  if (error_.empty()) error_ = "the link was lost";
  for (auto& [address, module] : modules_) module->forget_state();
}

awaitable<void> GatewayBus::look_after_modules() {
  const auto bus = bus_;
  while (!closed_ && bus->is_open()) {
    // Whoever does not answer keeps a serial line busy, which an axis on a path cannot wait for.
    std::vector<awaitable<tmcl::Result<void>>> questions;
    for (auto& [address, module] : modules_) {
      if (has_paths() || module->state() == GatewayModule::State::ready) continue;
      if (!module->is_configured()) continue;
      questions.push_back(module->be_ready());
    }
    if (!questions.empty()) co_await gather(std::move(questions));
    if (closed_ || !bus->is_open()) break;
    co_await changed_.wait_for(module_check_interval);
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
      error_ = event.text;
      changed_.notify();
      if (closed_) return;
      return emit({Kind::link_lost, config_.name, {}, 0, event.text});
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
    case GatewayEvent::Kind::lease_lost: return "lease_lost";
    case GatewayEvent::Kind::axis_stopped: return "axis_stopped";
    case GatewayEvent::Kind::orphan_stopped: return "orphan_stopped";
    case GatewayEvent::Kind::module_silent: return "module_silent";
    case GatewayEvent::Kind::module_answers: return "module_answers";
    case GatewayEvent::Kind::module_in_bootloader: return "module_in_bootloader";
    case GatewayEvent::Kind::module_reset: return "module_reset";
    case GatewayEvent::Kind::module_replaced: return "module_replaced";
  }
  return {};
}

// ---- modules -----------------------------------------------------------------------------------

GatewayModule* GatewayBus::find_module(tmcl::ModuleAddress address) const {
  const auto found = modules_.find(address);
  return found == modules_.end() ? nullptr : found->second.get();
}

GatewayModule& GatewayBus::add_module(tmcl::ModuleAddress address) {
  auto& module = modules_[address];
  if (module) return *module;
  const auto configured = std::ranges::find(config_.modules, address, &ModuleConfig::address);
  const bool is_told = configured != config_.modules.end();
  module = std::make_unique<GatewayModule>(*this, address,
                                           is_told ? configured->sentinel : SentinelConfig{});
  return *module;
}

// ---- calls -------------------------------------------------------------------------------------

tmcl::Error GatewayBus::not_open() const {
  tmcl::Error error;
  error.code = tmcl::Errc::link_lost;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = closed_ ? "the daemon is ending"
                          : "the bus is not open" + (error_.empty() ? "" : ": " + error_);
  error.hint =
      closed_ ? "" : "it is opened again as soon as that is possible; check cable and power";
  error.bus = config_.name;
  return error;
}

namespace {

constexpr std::uint8_t move_relative = 1;  // the type of MVP

bool is_relative_move(const tmcl::Request& request) {
  return request.command == tmcl::Command::MVP && request.type == move_relative;
}

/// If it came twice, the motor would go twice as far: read, add, and send where that is.
tmcl::Script<tmcl::Result<tmcl::Answer>> move_by(tmcl::Request request) {
  const auto add = [request](tmcl::Microsteps here) -> tmcl::Result<tmcl::Microsteps> {
    const auto target = std::int64_t{here.value} + request.value;
    if (std::in_range<std::int32_t>(target))
      return tmcl::Microsteps{static_cast<std::int32_t>(target)};
    return tl::unexpected(tmcl::bad_argument("it would end outside 32 bits", "move less far"));
  };
  const auto target = co_await tmcl::verbs::move_from_here({request.address, request.motor}, add);
  if (!target) co_return tl::unexpected(target.error());
  tmcl::Answer answer;
  answer.reply = {tmcl::default_host_address, tmcl::reply_byte(request.address), tmcl::Status::ok,
                  request.command, target->value};
  co_return answer;
}

}  // namespace

awaitable<tmcl::Result<tmcl::Answer>> GatewayBus::execute(tmcl::Request request,
                                                          RunOptions options) {
  if (!bus_) {
    auto error = not_open();
    error.request = request;
    co_return tl::unexpected(std::move(error));
  }
  auto* module = find_module(request.address);
  const bool asks = effect_of(request.command, request.type) == tmcl::Effect::reads;
  // What is read or checked while it is on its way may be from before it.
  if (module != nullptr && !asks) module->note_settings_changed();
  auto script = is_relative_move(request) ? move_by(request) : tmcl::verbs::command(request);
  auto answer = co_await run(std::move(script), std::move(options));
  if (module == nullptr) co_return answer;
  if (!answer) module->note(answer.error());
  if (!asks) module->note_settings_changed();
  co_return answer;
}

// ---- what may be sent --------------------------------------------------------------------------

namespace {

constexpr tmcl::Duration claim_look_interval = 5ms;

tmcl::Script<bool> has_arrived(tmcl::AxisAddress motor) {
  const auto state = co_await tmcl::verbs::state(motor);
  co_return state && state->velocity.value == 0 && state->position == state->target;
}

/// Whoever sees an axis at the end of its line can see it before the line does.
tmcl::Script<bool> sees_end_of_line(const Motors& motors, tmcl::AxisAddress motor) {
  const auto claimant = motors.claimant_of(motor);
  const bool ends = co_await has_arrived(motor);
  const auto looks = ends ? Motors::time_to_be_free / claim_look_interval : 0;
  for (auto i = looks; i > 0 && motors.claimant_of(motor) == claimant; --i)
    co_await tmcl::pause(claim_look_interval);
  co_return motors.claimant_of(motor) != claimant;
}

}  // namespace

tmcl::Script<tmcl::Result<void>> GatewayBus::may_send(tmcl::Request request, Permit permit) {
  while (const auto motor = motors_.claimed_by_other(request, permit)) {
    const auto claimant = motors_.claimant_of(*motor);
    if (claimant.by == Mover::search) {
      auto seen = co_await see_search_end(*motor);
      if (!seen) co_return seen;
      continue;
    }
    if (claimant.by != Mover::line) co_return tl::unexpected(motors_.claimed(*motor));
    const bool is_over = co_await sees_end_of_line(motors_, *motor);
    if (!is_over) co_return tl::unexpected(motors_.claimed(*motor));
  }
  auto objection = motors_.objection(request, permit);
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return tmcl::Result<void>{};
}

/// Nobody waits for a search that was only started. A module that cannot tell whether it searches
/// locks nobody out.
tmcl::Script<tmcl::Result<void>> GatewayBus::see_search_end(tmcl::AxisAddress motor) {
  const auto claimant = motors_.claimant_of(motor);
  auto step = co_await tmcl::verbs::reference_search_status(motor);
  if (!step && step.error().outcome != tmcl::Outcome::refused) {
    step.error().outcome = tmcl::Outcome::not_sent;
    co_return tl::unexpected(std::move(step.error()));
  }
  if (motors_.claimant_of(motor) != claimant) co_return tmcl::Result<void>{};
  if (step && *step != 0) co_return tl::unexpected(motors_.claimed(motor));
  motors_.release(motor, claimant.of);
  co_return tmcl::Result<void>{};
}

namespace {

// Where a line is so busy that a movement does not get its turn within the age of a sentinel, it
// goes out after so many of them all the same.
constexpr int most_admissions = 3;

std::optional<tmcl::TimePoint> earliest(std::optional<tmcl::TimePoint> one,
                                        std::optional<tmcl::TimePoint> other) {
  return one && other ? std::min(one, other) : one ? one : other;
}

/// Whoever sends a request may be ended at any time: it is on its way for as long as this lives.
class OnItsWay {
 public:
  OnItsWay(Motors& motors, const tmcl::Request& request, Permit of)
      : motors_(motors), request_(request) {
    motors_.begin(request_, of);
  }
  OnItsWay(const OnItsWay&) = delete;
  OnItsWay& operator=(const OnItsWay&) = delete;
  ~OnItsWay() { motors_.end(request_); }

 private:
  Motors& motors_;
  tmcl::Request request_;
};

// An upload of firmware was judged when it began: a module must not be left in its bootloader.
bool is_judged(const tmcl::step::Exchange& exchange) {
  const bool ends_upload =
      exchange.options.hold && exchange.request.command == tmcl::Command::BOOT_START_APPLICATION;
  return can_move(exchange.request) && !exchange.options.is_program_line && !ends_upload;
}

}  // namespace

/// The one whose sentinel can be asked along with this. Who holds a module waits for no one else.
GatewayModule* GatewayBus::watched_module(const tmcl::step::Exchange& exchange) const {
  return exchange.options.hold ? nullptr : find_module(exchange.request.address);
}

tmcl::Script<tmcl::Result<void>> GatewayBus::admit(tmcl::step::Exchange exchange,
                                                   const RunOptions& options) {
  auto* module = watched_module(exchange);
  // Each of the questions may take its time, and what was allowed before may not be any more.
  while (true) {
    if (module != nullptr) co_await must(module->watch(options.sentinel_age));
    auto allowed = co_await may_send(exchange.request, options.permit);
    if (!allowed) co_return allowed;
    auto check = options.recheck ? options.recheck() : std::nullopt;
    if (!check) break;
    allowed = co_await std::move(*check);
    if (!allowed) co_return allowed;
  }
  auto objection = options.objection ? options.objection() : std::nullopt;
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<tmcl::Answer>> GatewayBus::send(tmcl::step::Exchange exchange,
                                                          Conduct& conduct) {
  const auto& request = exchange.request;
  if (!is_judged(exchange) && effect_of(request.command, request.type) == tmcl::Effect::writes) {
    if (auto objection = motors_.objection_to_write(request, conduct.options.permit)) {
      objection->request = request;
      co_return tl::unexpected(std::move(*objection));
    }
  }
  if (!exchange.options.is_program_line) {
    auto kept = co_await keep_limits(request, conduct.options.permit);
    if (!kept) {
      conduct.refused = true;
      kept.error().request = request;
      co_return tl::unexpected(std::move(kept.error()));
    }
  }
  const auto given = earliest(exchange.options.deadline, conduct.options.deadline);
  for (auto tries = is_judged(exchange) ? most_admissions : 0; tries > 0; --tries) {
    auto allowed = co_await admit(exchange, conduct.options);
    if (!allowed) {
      conduct.refused = true;
      allowed.error().request = exchange.request;
      co_return tl::unexpected(std::move(allowed.error()));
    }
    auto bounded = exchange;
    const auto* module = watched_module(exchange);
    const bool is_watched = module != nullptr && module->sentinel().watches();
    if (!is_watched || tries == 1) break;
    const auto limit = module->sentinel().last_seen() + conduct.options.sentinel_age;
    bounded.options.deadline = earliest(given, limit);
    auto answer = co_await send_once(std::move(bounded), conduct);
    const bool expired = !answer && answer.error().code == tmcl::Errc::deadline_passed;
    if (!expired || bounded.options.deadline == given) co_return answer;
  }
  auto answer = co_await send_once(std::move(exchange), conduct);
  co_return answer;
}

tmcl::Script<tmcl::Result<void>> GatewayBus::keep_limits(tmcl::Request request, Permit permit) {
  if (permit.exceeds_limits) co_return tmcl::Result<void>{};
  for (const auto& limits : limits_) {
    auto kept = co_await limits->check(request);
    if (!kept) co_return kept;
  }
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<tmcl::Answer>> GatewayBus::send_once(tmcl::step::Exchange exchange,
                                                               Conduct& conduct) {
  const auto request = exchange.request;
  conduct.module = watched_module(exchange);
  std::optional<OnItsWay> on_its_way;
  if (is_judged(exchange)) on_its_way.emplace(motors_, request, conduct.options.permit);
  const tmcl::AxisAddress motor{request.address, request.motor};
  const auto claimant = motors_.claimant_of(motor);
  const auto turning = motors_.turning_of(motor);
  const bool asks = effect_of(request.command, request.type) == tmcl::Effect::reads;
  // What is read while it is on its way may be from before it.
  if (!asks) ++commands_;
  const bool is_proven = exchange.options.proof != tmcl::Proof::none;
  tmcl::StepResult answers;
  if (is_proven) {
    answers = co_await exchange_all(std::vector(1, std::move(exchange)));
  } else {
    auto one = co_await tmcl::exchange(request, exchange.options);
    answers.push_back(std::move(one));
  }
  auto& answer = answers.front();
  if (!asks) ++commands_;
  on_its_way.reset();
  if (auto* module = find_module(request.address)) module->note_sent(request);
  motors_.note(request, answer, claimant, turning);
  for (const auto& limits : limits_) limits->note(request, answer);
  const bool may_be_done = answer || answer.error().outcome == tmcl::Outcome::unknown;
  conduct.acted = conduct.acted || (may_be_done && !asks);
  co_return std::move(answer);
}

/// What is proven by another command behind it, is proven by the question of the sentinel.
tmcl::Script<tmcl::StepResult> GatewayBus::exchange_all(
    std::vector<tmcl::step::Exchange> exchanges) {
  const auto& last = exchanges.back();
  auto* module = last.options.proof == tmcl::Proof::none ? nullptr : watched_module(last);
  const bool asks_more = module != nullptr && module->sentinel().watches();
  if (asks_more) {
    tmcl::CallOptions options;
    options.deadline = last.options.deadline;
    exchanges.push_back({module->sentinel().question(last.request.address), options});
  }
  const auto asked = co_await tmcl::current_time();
  auto results = co_await tmcl::exchange_all(std::move(exchanges));
  const auto answered = co_await tmcl::current_time();
  if (asks_more) {
    module->note_sentinel(results.back(), asked, answered);
    results.pop_back();
  }
  co_return results;
}

std::optional<tmcl::Error> GatewayBus::objection_to(const tmcl::Step& step,
                                                    const Conduct& conduct) {
  // What is judged is refused in send(), and a verb that was refused sets back what it has set.
  const auto* one = std::get_if<tmcl::step::Exchange>(&step);
  const bool goes_on = conduct.refused || (one != nullptr && is_judged(*one));
  if (!conduct.options.objection || goes_on) return std::nullopt;
  auto objection = conduct.options.objection();
  if (objection && conduct.acted) objection->outcome = tmcl::Outcome::unknown;
  return objection;
}

tmcl::Script<tmcl::StepResult> GatewayBus::carry_out(tmcl::Step step, Conduct& conduct) {
  tmcl::StepResult results;
  if (const auto* pause = std::get_if<tmcl::step::Pause>(&step)) {
    co_await tmcl::pause(pause->duration);
    // Who waits for something is told when the module will never do it.
    if (conduct.module != nullptr) co_await conduct.module->watch(conduct.options.sentinel_age);
  } else if (auto* one = std::get_if<tmcl::step::Exchange>(&step)) {
    auto answer = co_await send(std::move(*one), conduct);
    results.push_back(std::move(answer));
  } else {
    auto& all = std::get<tmcl::step::ExchangeAll>(step).exchanges;
    const bool moves =
        std::ranges::any_of(all, [](const auto& each) { return can_move(each.request); });
    if (!moves) {
      results = co_await exchange_all(std::move(all));
      co_return results;
    }
    for (auto& each : all) {
      auto answer = co_await send(std::move(each), conduct);
      results.push_back(std::move(answer));
    }
  }
  co_return results;
}

}  // namespace tmcld

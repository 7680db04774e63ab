// What a bus lets out: see the header.
#include "gateway/authority/gate.hpp"

#include <algorithm>
#include <utility>

#include "async/spawn.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/authority/charge.hpp"
#include "gateway/authority/in_flight.hpp"
#include "gateway/axis/stop_cause.hpp"
#include "gateway/bus.hpp"

namespace tmcld {

using boost::asio::awaitable;

boost::asio::awaitable<void> Gate::begin_turning(Conduct& conduct) {
  if (!conduct.options.announced) co_return;
  const auto& announced = *conduct.options.announced;
  conduct.turning = motors_.begin_turning(
      tmcl::motors_turned_by(announced, bus_.model_of(announced.address)), conduct.options.permit);
  if (!conduct.turning.empty() && bus_.journal()) co_await Journal::write(bus_.journal());
}

namespace {

// Where a line is so busy that a movement does not get its turn within the age of a sentinel, or
// within the time that makes a gap, it is admitted again, so often.
constexpr int most_admissions = 10;

tmcl::Error too_busy() {
  return tmcl::not_sent(tmcl::Errc::queue_full,
                        "the movement had to wait for too long behind other commands of its bus, " +
                            std::to_string(most_admissions) + " times",
                        "send fewer commands at once, or use a faster bus");
}

std::optional<tmcl::TimePoint> earliest(std::optional<tmcl::TimePoint> one,
                                        std::optional<tmcl::TimePoint> other) {
  return one && other ? std::min(one, other) : one ? one : other;
}

tmcl::Error has_its_share(const tmcl::Request& request) {
  auto error =
      tmcl::not_sent(tmcl::Errc::queue_full,
                     "this client has as many commands waiting for the bus as its share allows",
                     "wait for answers before sending more");
  error.request = request;
  return error;
}

void say_that_it_is_owed(tmcl::Error& error) {
  if (error.hint.starts_with(owed_stop_hint)) return;
  error.hint = std::string(owed_stop_hint) + (error.hint.empty() ? "" : "; ") + error.hint;
}

// An upload of firmware was judged when it began: a module must not be left in its bootloader. What
// a line of a program does it does when the program runs.
bool moves(const tmcl::step::Exchange& exchange) {
  const bool ends_upload =
      exchange.options.hold && exchange.request.command == tmcl::Command::BOOT_START_APPLICATION;
  return can_move(exchange.request) && !exchange.options.is_program_line && !ends_upload;
}

bool is_judged(const tmcl::step::Exchange& exchange) {
  const auto effect = effect_of(exchange.request.command, exchange.request.type);
  return effect == tmcl::Effect::writes || moves(exchange);
}

/// The module has taken it for its memory: nothing moves or stops by it.
bool is_recorded(const tmcl::Result<tmcl::Answer>& answer) {
  return answer && answer->reply.status == tmcl::Status::command_loaded;
}

bool keeps_limits(const tmcl::step::Exchange& exchange, Permit permit) {
  return !permit.exceeds_limits && !exchange.options.is_program_line;
}

}  // namespace

/// The one whose sentinel can be asked along with this. Who holds a module waits for no one else.
GatewayModule* Gate::watched_module(const tmcl::step::Exchange& exchange) const {
  return exchange.options.hold ? nullptr : bus_.find_module(exchange.request.address);
}

Gate::Script<void> Gate::admit(tmcl::step::Exchange exchange, const RunOptions& options) {
  const auto& request = exchange.request;
  auto* module = moves(exchange) ? watched_module(exchange) : nullptr;
  const auto asks = exchange.options.hold ? Asks::nothing : Asks::what_may_have_ended;
  if (keeps_limits(exchange, options.permit)) co_await must(keep_limits(request));
  // Each of the questions may take its time, and what was allowed before may not be any more.
  while (true) {
    if (module != nullptr) co_await must(module->watch(options.sentinel_age));
    co_await must(may_send(request, options.permit, asks));
    const auto& premise = options.premise;
    const bool has_changed = moves(exchange) && premise.has_changed && premise.has_changed();
    if (!has_changed) break;
    co_await must(premise.check());
  }
  auto objection = moves(exchange) && options.objection ? options.objection() : std::nullopt;
  if (objection) co_return tl::unexpected(std::move(*objection));
  co_return tmcl::Result<void>{};
}

Gate::Script<tmcl::Answer> Gate::send(tmcl::step::Exchange exchange, Conduct& conduct) {
  const auto request = exchange.request;
  const auto refused = [&](tmcl::Error error) {
    error.request = request;
    return tmcl::Result<tmcl::Answer>(tl::unexpected(std::move(error)));
  };
  if (!is_judged(exchange)) {
    auto answer = co_await send_once(std::move(exchange), conduct);
    co_return answer;
  }
  for (auto tries = most_admissions; tries > 0; --tries) {
    auto allowed = co_await admit(exchange, conduct.options);
    conduct.refused = conduct.refused || !allowed;
    if (!allowed) co_return refused(std::move(allowed.error()));
    // It turned for another client when the verb began, which has gone, as this one may before the
    // answer.
    if (conduct.turning.empty() && !exchange.options.hold) {
      conduct.turning = motors_.begin_turning(
          tmcl::motors_turned_by(request, bus_.model_of(request.address)), conduct.options.permit);
      if (!conduct.turning.empty()) write_journal();
    }
    auto answer = co_await send_admitted(exchange, conduct);
    if (answer) co_return std::move(*answer);
  }
  conduct.refused = true;
  co_return refused(too_busy());
}

std::optional<tmcl::TimePoint> Gate::admitted_until(const tmcl::step::Exchange& exchange,
                                                    const RunOptions& options) const {
  if (!moves(exchange)) return std::nullopt;
  const auto* module = watched_module(exchange);
  // What still waits for its turn when the reactor stands still has to be asked about again.
  std::optional<tmcl::TimePoint> until = bus_.clock().now() + Gaps::longest_gap;
  if (module != nullptr && module->is_watched())
    until = earliest(until, module->sentinel().counts_until(options.sentinel_age));
  return until;
}

tmcl::Script<std::optional<tmcl::Result<tmcl::Answer>>> Gate::send_admitted(
    tmcl::step::Exchange exchange, Conduct& conduct) {
  auto& options = exchange.options;
  const auto given = earliest(options.deadline, conduct.options.deadline);
  options.deadline = earliest(given, admitted_until(exchange, conduct.options));
  const bool is_earlier = options.deadline != given;
  // As long as this lives, so does the conduct.
  const auto has_changed = std::make_shared<bool>(false);
  options.objection = [this, &conduct, exchange,
                       of = std::weak_ptr(has_changed)]() -> std::optional<tmcl::Error> {
    const auto verdict_changes = of.lock();
    if (!verdict_changes) return tmcl::bad_argument("the call has ended that asked for it");
    return last_objection(exchange, conduct.options, *verdict_changes);
  };
  auto answer = co_await send_once(std::move(exchange), conduct);
  const bool was_sent = answer || answer.error().outcome != tmcl::Outcome::not_sent;
  const bool expired = !was_sent && answer.error().code == tmcl::Errc::deadline_passed;
  if ((expired && is_earlier) || (!was_sent && *has_changed)) co_return std::nullopt;
  co_return std::optional(std::move(answer));
}

std::optional<tmcl::Error> Gate::last_objection(const tmcl::step::Exchange& exchange,
                                                const RunOptions& options,
                                                bool& has_changed) const {
  const auto& request = exchange.request;
  look_for_gap();
  const auto it = judge(request, options.permit);
  if (it.verdict.ruling == Ruling::refuse) return motors_.refusal(it.motor, it.verdict.because);
  const bool is_limited = keeps_limits(exchange, options.permit);
  const auto must_read = [&](const auto& limits) { return limits->must_read(request); };
  has_changed = it.verdict.ruling == Ruling::ask ||
                (moves(exchange) && options.premise.has_changed && options.premise.has_changed()) ||
                (is_limited && std::ranges::any_of(limits_, must_read));
  if (has_changed) return motors_.refusal(it.motor, it.verdict.because);
  for (const auto& limits : limits_)
    if (auto objection = is_limited ? limits->objection(request) : std::nullopt) return objection;
  return moves(exchange) && options.objection ? options.objection() : std::nullopt;
}

Gate::Script<void> Gate::keep_limits(tmcl::Request request) {
  for (const auto& limits : limits_) co_await must(limits->check(request));
  co_return tmcl::Result<void>{};
}

Gate::Script<tmcl::Answer> Gate::send_once(tmcl::step::Exchange exchange, Conduct& conduct) {
  const auto request = exchange.request;
  conduct.module = watched_module(exchange);
  std::optional<MoveInFlight> in_flight;
  auto* module = bus_.find_module(request.address);
  if (moves(exchange)) in_flight.emplace(motors_, module, request, conduct.options.permit);
  ModuleMarks::Mark change;
  if (intent_of(request).changes_coordinates)
    change = motors_.coordinates().changes.set(request.address);
  const auto before =
      motors_.before(request, conduct.options.permit, bus_.model_of(request.address));
  std::optional<StopOnItsWay> stop_on_its_way;
  conduct.owes_stop = false;
  if (is_stop(intent_of(request)) && !exchange.options.is_program_line)
    stop_on_its_way.emplace([this, &conduct, request] { conduct.owes_stop = owe(request); });
  const bool asks = effect_of(request.command, request.type) == tmcl::Effect::reads;
  // What is read while it is on its way may be from before it.
  if (!asks) ++commands_;
  const bool is_proven = exchange.options.proof != tmcl::Proof::none;
  tmcl::StepResult answers;
  if (is_proven) {
    answers = co_await exchange_all(std::vector(1, std::move(exchange)));
  } else {
    auto one = co_await tmcl::exchange(request, exchange.options);
    note_answer(request, one);
    answers.push_back(std::move(one));
  }
  auto& answer = answers.front();
  if (!asks) ++commands_;
  if (stop_on_its_way) stop_on_its_way->note(answer);
  stop_on_its_way.reset();
  if (is_recorded(answer)) {
    conduct.acted = true;
    co_return std::move(answer);
  }
  if (answer) owed_stops_.remove(request);
  if (conduct.owes_stop) say_that_it_is_owed(answer.error());
  if (conduct.owes_stop && module != nullptr) module->note(answer.error());
  if (in_flight) in_flight->note(answer);
  in_flight.reset();
  if (module != nullptr) module->note_sent(request);
  motors_.note(request, answer, before);
  for (const auto& limits : limits_) limits->note(request, answer);
  if (answer) tell_setting(request, before);
  const bool may_be_done = answer || answer.error().outcome == tmcl::Outcome::unknown;
  if (may_be_done && starts_search(request) && on_search_)
    on_search_({request.address, request.motor}, conduct.options.permit);
  conduct.acted = conduct.acted || (may_be_done && !asks);
  co_return std::move(answer);
}

void Gate::tell_setting(const tmcl::Request& request, const Motors::Before& before) const {
  const bool is_known = request.command == tmcl::Command::SAP;
  const bool sets =
      is_known || request.command == tmcl::Command::RSAP || request.command == tmcl::Command::AAP;
  const bool is_of_client =
      before.of.number != 0 && before.of.number != before.claim_owner.of.number;
  if (!sets || !is_of_client || !on_setting_) return;
  on_setting_({request.address, request.motor}, request.type,
              is_known ? std::optional(request.value) : std::nullopt);
}

// ---- stops that were not answered --------------------------------------------------------------

bool Gate::owe(const tmcl::Request& stop) {
  if (bus_.is_closed()) return false;
  const bool is_news = !owed_stops_.has(stop);
  if (!owed_stops_.add(stop)) return false;
  const bool matters = motors_.may_move({stop.address, stop.motor});
  if (is_news && matters) write_journal();
  return true;
}

bool Gate::owe_first(tmcl::AnyScript& script) {
  const auto step = script.start(bus_.clock().now());
  const auto* first = step ? std::get_if<tmcl::step::Exchange>(&*step) : nullptr;
  return first != nullptr && is_stop(intent_of(first->request)) && owe(first->request);
}

Gate::Script<void> Gate::pay_stops(tmcl::ModuleAddress module) {
  std::vector<tmcl::Request> paid;
  const auto stops = owed_stops_.of(module);
  for (const auto& stop : stops) {
    // Another call may have sent it meanwhile.
    if (!owed_stops_.has(stop)) continue;
    // The program may have moved its motors since.
    const bool ends = OwedStops::ends_program(stop);
    if (ends)
      for (const auto& motor : paid) owed_stops_.add(motor);
    co_await must(pay_stop(stop));
    if (ends)
      for (const auto& motor : paid) co_await must(pay_stop(motor));
    paid.push_back(stop);
  }
  co_return tmcl::Result<void>{};
}

Gate::Script<void> Gate::pay_stop(tmcl::Request stop) {
  Conduct conduct;
  auto answer = co_await send_once({stop, {}}, conduct);
  if (conduct.owes_stop) {
    answer.error().outcome = tmcl::Outcome::not_sent;
    co_return tl::unexpected(std::move(answer.error()));
  }
  owed_stops_.remove(stop);
  if (answer) tell_paid(stop);
  co_return tmcl::Result<void>{};
}

awaitable<void> Gate::pay_stops(std::shared_ptr<GatewayBus> bus, tmcl::ModuleAddress module) {
  // Those that fail are kept for the next time.
  co_await bus->run(bus->gate().pay_stops(module), {});
}

void Gate::send_owed_stops(tmcl::ModuleAddress module) {
  if (owes_stop(module)) spawn(bus_.executor(), pay_stops(bus_.shared_from_this(), module));
}

void Gate::send_owed_stops() {
  for (const auto module : owed_stops_.modules()) send_owed_stops(module);
}

void Gate::write_journal() const {
  if (bus_.journal()) spawn(bus_.executor(), Journal::write(bus_.journal()));
}

void Gate::tell_paid(const tmcl::Request& stop) {
  const tmcl::AxisAddress motor{stop.address, stop.motor};
  const auto by = motors_.claim_owner_of(motor).by;
  const bool is_led = by != ClaimKind::none && by != ClaimKind::search;
  if (stop.command != tmcl::Command::MST || is_led) return;
  GatewayEvent event{GatewayEvent::Kind::axis_stopped, bus_.name(), number(motor.module),
                     1 << motor.motor};
  event.text = "motor " + std::to_string(motor.motor) +
               " is stopped: its module has taken the stop that could not be sent before";
  event.cause = name_of(StopCause::client);
  bus_.emit(std::move(event));
}

void Gate::note_answer(const tmcl::Request& request, const tmcl::Result<tmcl::Answer>& answer) {
  auto* module = bus_.find_module(request.address);
  if (module != nullptr && answer) module->note_answer(request, *answer);
}

/// What is proven by another command behind it, is proven by the question of the sentinel.
tmcl::Script<tmcl::StepResult> Gate::exchange_all(std::vector<tmcl::step::Exchange> exchanges) {
  if (exchanges.empty()) co_return std::vector<tmcl::Result<tmcl::Answer>>();
  const auto last = exchanges.back();
  auto* module = last.options.proof == tmcl::Proof::none ? nullptr : watched_module(last);
  const bool asks_more =
      module != nullptr && module->sentinel().watches() && module->sentinel().is_unmistakable();
  if (asks_more) {
    tmcl::CallOptions options;
    options.deadline = last.options.deadline;
    exchanges.push_back({module->sentinel().question(last.request.address), options});
  }
  std::vector<tmcl::Request> requests;
  for (const auto& one : exchanges) requests.push_back(one.request);
  auto results = co_await tmcl::exchange_all(std::move(exchanges));
  for (std::size_t i = 0; i < results.size(); ++i) note_answer(requests[i], results[i]);
  if (asks_more) {
    module->note_sentinel(requests.back(), results.back());
    results.pop_back();
  }
  co_return results;
}

boost::asio::awaitable<Gate::Ended> Gate::run(tmcl::AnyScript& script, RunOptions options) {
  const auto bus = bus_.line();
  if (!bus) {
    auto error = bus_.not_open();
    if (owe_first(script)) say_that_it_is_owed(error);
    co_return Ended{std::move(error)};
  }
  // Steps of one verb all go to the link it began on: after a loss another module may be there.
  tmcl::RunOptions of_bus{options.deadline, {}, options.on_answer};
  of_bus.objection = [this, bus] {
    return bus == bus_.line() ? std::nullopt : std::optional(bus_.not_open());
  };
  Conduct conduct{std::move(options)};
  co_await begin_turning(conduct);
  Charge charge{conduct.options.permit, conduct.acted, motors_.arrivals()};
  auto steps = charged(step_through(script, conduct), std::move(charge));
  auto ended = co_await bus->run(std::move(steps), std::move(of_bus));
  if (!ended) {
    if (conduct.owes_stop) say_that_it_is_owed(ended.error());
    co_return Ended{std::move(ended.error()), false, std::move(conduct.turning)};
  }
  co_return Ended{std::nullopt, conduct.refused && conduct.acted, std::move(conduct.turning)};
}

Gate::Script<void> Gate::step_through(tmcl::AnyScript& script, Conduct& conduct) {
  auto now = co_await tmcl::current_time();
  auto step = script.start(now);
  while (step) {
    auto objection = objection_to(*step, conduct);
    if (objection) co_return tl::unexpected(std::move(*objection));
    auto result = co_await carry_out(std::move(*step), conduct);
    now = co_await tmcl::current_time();
    step = script.resume(std::move(result), now);
  }
  co_return tmcl::Result<void>{};
}

std::optional<tmcl::Error> Gate::objection_to(const tmcl::Step& step, const Conduct& conduct) {
  // What is judged is refused in send(), and a verb that was refused sets back what it has set.
  const auto* one = std::get_if<tmcl::step::Exchange>(&step);
  const bool goes_on = conduct.refused || (one != nullptr && moves(*one));
  if (!conduct.options.objection || goes_on) return std::nullopt;
  auto objection = conduct.options.objection();
  if (objection && conduct.acted) objection->outcome = tmcl::Outcome::unknown;
  return objection;
}

tmcl::Script<tmcl::StepResult> Gate::carry_out(tmcl::Step step, Conduct& conduct) {
  tmcl::StepResult results;
  if (const auto* pause = std::get_if<tmcl::step::Pause>(&step)) {
    co_await tmcl::pause(pause->duration);
    // Who waits for something is told when the module will never do it.
    if (conduct.module != nullptr) co_await conduct.module->watch(conduct.options.sentinel_age);
  } else if (auto* one = std::get_if<tmcl::step::Exchange>(&step)) {
    const auto request = one->request;
    const auto place =
        shares_.take(conduct.options.permit.client, effect_of(request.command, request.type));
    if (!place) {
      results.emplace_back(tl::unexpected(has_its_share(request)));
      co_return results;
    }
    auto answer = co_await send(std::move(*one), conduct);
    results.push_back(std::move(answer));
  } else {
    auto& all = std::get<tmcl::step::ExchangeAll>(step).exchanges;
    const bool only_asks = std::ranges::all_of(all, [](const auto& each) {
      return effect_of(each.request.command, each.request.type) == tmcl::Effect::reads;
    });
    if (only_asks) {
      const auto place =
          shares_.take(conduct.options.permit.client, tmcl::Effect::reads, all.size());
      for (const auto& each : all)
        if (!place) results.emplace_back(tl::unexpected(has_its_share(each.request)));
      if (place) results = co_await exchange_all(std::move(all));
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

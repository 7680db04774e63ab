// What a bus lets out: each request of a verb is judged just before it goes to the engine.
#include "gateway/bus.hpp"

#include <algorithm>
#include <utility>

#include "async/spawn.hpp"
#include "gateway/authority/axis_limits.hpp"
#include "gateway/axis/stop_cause.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using boost::asio::awaitable;

constexpr tmcl::Duration claim_look_interval = std::chrono::milliseconds(5);
constexpr tmcl::Duration coordinate_look_interval = std::chrono::milliseconds(1);

tmcl::Script<bool> has_arrived(tmcl::AxisAddress motor) {
  const auto state = co_await tmcl::verbs::state(motor);
  co_return state && state->velocity.value == 0 && state->position == state->target;
}

}  // namespace

Motors::Judgement GatewayBus::judge(const tmcl::Request& request, Permit permit) const {
  return motors_.judge(request, permit, clock_.now(), owes_stop(request.address));
}

tmcl::Script<tmcl::Result<void>> GatewayBus::may_send(tmcl::Request request, Permit permit,
                                                      Asks asks) {
  std::optional<Motors::Judgement> asked;
  while (true) {
    motors_.look_for_gap(clock_.now());
    const auto it = judge(request, permit);
    if (it.verdict.ruling == Ruling::allow) co_return tmcl::Result<void>{};
    // What was asked about, and has not ended, refuses.
    const bool may_ask = asks == Asks::what_may_have_ended && it != asked;
    if (it.verdict.ruling == Ruling::refuse || !may_ask)
      co_return tl::unexpected(motors_.refusal(it.motor, it.verdict.because));
    asked = it;
    co_await must(ask_about(it));
  }
}

/// Another call can see an axis at the end of its line before the line does.
tmcl::Script<tmcl::Result<void>> GatewayBus::see_end_of_line(tmcl::AxisAddress motor) {
  const auto claimant = motors_.claimant_of(motor);
  const bool ends = co_await has_arrived(motor);
  const auto looks = ends ? Motors::time_to_be_free / claim_look_interval : 0;
  for (auto i = looks; i > 0 && motors_.claimant_of(motor) == claimant; --i)
    co_await tmcl::pause(claim_look_interval);
  co_return tmcl::Result<void>{};
}

/// What cannot be seen to stand turns on, as far as is known.
tmcl::Script<tmcl::Result<void>> GatewayBus::look_whether_it_turns(tmcl::AxisAddress motor) {
  co_await see_turning_end(motor);
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<void>> GatewayBus::see_coordinates_released(tmcl::ModuleAddress module) {
  while (motors_.coordinate_holds().has(module)) co_await tmcl::pause(coordinate_look_interval);
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<void>> GatewayBus::ask_about(Motors::Judgement it) {
  switch (it.verdict.because) {
    case Obstacle::claimed_by_search: return see_search_end(it.motor);
    case Obstacle::claimed_by_line: return see_end_of_line(it.motor);
    case Obstacle::turns_for_other: return look_whether_it_turns(it.motor);
    case Obstacle::stop_owed: return pay_stops(it.motor.module);
    default: return see_coordinates_released(it.motor.module);
  }
}

namespace {

/// A status does not say how a search has ended. One that has found its reference has made that
/// zero, and the axis stands there. Flags tell nothing: a search for a stall ends with one, too.
std::vector<tmcl::step::Exchange> questions_about_search(tmcl::AxisAddress motor) {
  const auto ask = [&](tmcl::Command command, std::uint8_t type) {
    tmcl::step::Exchange question{{motor.module, command, type, motor.motor, 0}, {}};
    question.options.proof = tmcl::Proof::followed;
    return question;
  };
  return {ask(tmcl::Command::RFS, tmcl::search_type::status),
          ask(tmcl::Command::GAP, tmcl::axis_parameter::actual_velocity),
          ask(tmcl::Command::GAP, tmcl::axis_parameter::actual_position)};
}

}  // namespace

/// A module that cannot tell whether it searches locks no client out.
tmcl::Script<tmcl::Result<void>> GatewayBus::see_search_end(tmcl::AxisAddress motor) {
  const auto claimant = motors_.claimant_of(motor);
  const auto answers = co_await exchange_all(questions_about_search(motor));
  for (const auto& answer : answers) {
    if (answer || answer.error().outcome == tmcl::Outcome::refused) continue;
    auto error = answer.error();
    error.outcome = tmcl::Outcome::not_sent;
    co_return tl::unexpected(std::move(error));
  }
  if (motors_.claimant_of(motor) != claimant) co_return tmcl::Result<void>{};
  const auto& status = answers.front();
  if (status && status->reply.value != 0)
    co_return tl::unexpected(motors_.refusal(motor, Obstacle::claimed_by_search));
  const auto is_zero = [](const auto& answer) { return answer && answer->reply.value == 0; };
  if (std::ranges::all_of(answers, is_zero)) motors_.note_reference(motor);
  motors_.release(motor, claimant.of);
  co_return tmcl::Result<void>{};
}

// ---- turning without end -----------------------------------------------------------------------

boost::asio::awaitable<void> GatewayBus::begin_turning(Conduct& conduct) {
  if (!conduct.options.announced) co_return;
  const auto& announced = *conduct.options.announced;
  conduct.turning = motors_.begin_turning(
      tmcl::motors_turned_by(announced, model_of(announced.address)), conduct.options.permit);
  if (!conduct.turning.empty() && journal_) co_await Journal::write(journal_);
}

const tmcl::Model* GatewayBus::model_of(tmcl::ModuleAddress address) const {
  const auto* module = find_module(address);
  return module == nullptr ? nullptr : module->model();
}

namespace {

std::optional<tmcl::ModeParameter> mode_of(const tmcl::Model* model) {
  if (model == nullptr) return std::nullopt;
  return tmcl::mode_parameter(tmcl::axis_parameters(*model));
}

std::vector<tmcl::step::Exchange> questions_about_turning(
    tmcl::AxisAddress motor, const std::optional<tmcl::ModeParameter>& mode) {
  std::vector<std::uint8_t> parameters{tmcl::axis_parameter::actual_velocity,
                                       tmcl::axis_parameter::target_velocity};
  if (mode) parameters.push_back(mode->number);
  std::vector<tmcl::step::Exchange> questions;
  for (const auto parameter : parameters) {
    questions.push_back({{motor.module, tmcl::Command::GAP, parameter, motor.motor, 0}, {}});
    questions.back().options.proof = tmcl::Proof::twice;
  }
  return questions;
}

}  // namespace

tmcl::Script<tmcl::Result<bool>> GatewayBus::may_turn(tmcl::AxisAddress motor) {
  const auto mode = mode_of(model_of(motor.module));
  auto questions = questions_about_turning(motor, mode);
  const auto answers = co_await exchange_all(std::move(questions));
  for (const auto& answer : answers) {
    if (!answer && answer.error().outcome != tmcl::Outcome::refused)
      co_return tl::unexpected(answer.error());
  }
  const auto& told = answers.back();
  if (mode && told && !may_turn_in(*mode, told->reply.value)) co_return false;
  // A module that does not tell what it is to do is judged by what it does.
  const auto is_zero = [](const auto& answer) { return !answer || answer->reply.value == 0; };
  co_return !is_zero(answers[0]) || !is_zero(answers[1]);
}

tmcl::Script<tmcl::Result<void>> GatewayBus::see_turning_end(tmcl::AxisAddress motor) {
  const auto turning = motors_.turning_of(motor);
  // What is on its way may set it turning after it was looked at.
  if (turning.number == 0 || motors_.is_to_turn(motor)) co_return tmcl::Result<void>{};
  const auto turns = co_await may_turn(motor);
  if (!turns) co_return tl::unexpected(turns.error());
  if (!*turns) motors_.end_turning(motor, turning.number);
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<void>> GatewayBus::hold_still(tmcl::ModuleAddress module) {
  while (motors_.coordinate_changes().has(module)) co_await tmcl::pause(coordinate_look_interval);
  co_return tmcl::Result<void>{};
}

namespace {

// Where a line is so busy that a movement does not get its turn within the age of a sentinel, or
// within the time that makes a gap, it is admitted again, so often.
constexpr int most_admissions = 10;

tmcl::Error too_busy() {
  tmcl::Error error;
  error.code = tmcl::Errc::queue_full;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = "the movement had to wait for too long behind other commands of its bus, " +
                  std::to_string(most_admissions) + " times";
  error.hint = "send fewer commands at once, or use a faster bus";
  return error;
}

std::optional<tmcl::TimePoint> earliest(std::optional<tmcl::TimePoint> one,
                                        std::optional<tmcl::TimePoint> other) {
  return one && other ? std::min(one, other) : one ? one : other;
}

tmcl::Error has_its_share(const tmcl::Request& request) {
  tmcl::Error error;
  error.code = tmcl::Errc::queue_full;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = "this client has as many commands waiting for the bus as its share allows";
  error.hint = "wait for answers before sending more";
  error.request = request;
  return error;
}

void say_that_it_is_owed(tmcl::Error& error) {
  if (error.hint.starts_with(owed_stop_hint)) return;
  error.hint = std::string(owed_stop_hint) + (error.hint.empty() ? "" : "; ") + error.hint;
}

/// The call that sends a request may end at any time: it is on its way for as long as this lives.
class OnItsWay {
 public:
  OnItsWay(Motors& motors, GatewayModule* module, const tmcl::Request& request, Permit of)
      : motors_(motors), module_(module), request_(request) {
    motors_.begin(request_, of);
    if (module_ != nullptr) module_->note_sending(request_);
  }
  OnItsWay(const OnItsWay&) = delete;
  OnItsWay& operator=(const OnItsWay&) = delete;
  ~OnItsWay() {
    motors_.end(request_);
    if (module_ != nullptr) note_broken_off();
  }
  void note(const tmcl::Result<tmcl::Answer>& answer) {
    if (auto* module = std::exchange(module_, nullptr))
      module->note_moved(request_, answer.has_value());
  }

 private:
  /// Without memory for that a restart of its module is not noticed.
  void note_broken_off() noexcept {
    try {
      module_->note_moved(request_, false);
    } catch (...) {  // what ends like this ends for want of memory
    }
  }

  Motors& motors_;
  GatewayModule* module_;  ///< Null if none is watched, and when it has been told.
  tmcl::Request request_;
};

/// Keeps a stop that does not get an answer while this lives.
class StopOnItsWay {
 public:
  using Owe = std::function<void()>;
  explicit StopOnItsWay(Owe owe) : owe_(std::move(owe)) {}
  StopOnItsWay(const StopOnItsWay&) = delete;
  StopOnItsWay& operator=(const StopOnItsWay&) = delete;
  ~StopOnItsWay() {
    if (owe_) owe_();
  }
  /// Whether the module got it, or will not take it.
  void note(const tmcl::Result<tmcl::Answer>& answer) {
    const auto code = answer ? std::optional<tmcl::Errc>() : answer.error().code;
    const bool is_unreachable = code == tmcl::Errc::link_lost ||
                                code == tmcl::Errc::reply_timeout ||
                                code == tmcl::Errc::module_silent;
    if (!is_unreachable) owe_ = {};
  }

 private:
  Owe owe_;
};

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

bool keeps_limits(const tmcl::step::Exchange& exchange, Permit permit) {
  return !permit.exceeds_limits && !exchange.options.is_program_line;
}

}  // namespace

/// The one whose sentinel can be asked along with this. Who holds a module waits for no one else.
GatewayModule* GatewayBus::watched_module(const tmcl::step::Exchange& exchange) const {
  return exchange.options.hold ? nullptr : find_module(exchange.request.address);
}

tmcl::Script<tmcl::Result<void>> GatewayBus::admit(tmcl::step::Exchange exchange,
                                                   const RunOptions& options) {
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

tmcl::Script<tmcl::Result<tmcl::Answer>> GatewayBus::send(tmcl::step::Exchange exchange,
                                                          Conduct& conduct) {
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
          tmcl::motors_turned_by(request, model_of(request.address)), conduct.options.permit);
      if (!conduct.turning.empty() && journal_) spawn(executor_, Journal::write(journal_));
    }
    auto answer = co_await send_admitted(exchange, conduct);
    if (answer) co_return std::move(*answer);
  }
  conduct.refused = true;
  co_return refused(too_busy());
}

std::optional<tmcl::TimePoint> GatewayBus::admitted_until(const tmcl::step::Exchange& exchange,
                                                          const RunOptions& options) const {
  if (!moves(exchange)) return std::nullopt;
  const auto* module = watched_module(exchange);
  // What still waits for its turn when the reactor stands still has to be asked about again.
  std::optional<tmcl::TimePoint> until = clock_.now() + Gaps::longest_gap;
  if (module != nullptr && module->is_watched())
    until = earliest(until, module->sentinel().counts_until(options.sentinel_age));
  return until;
}

tmcl::Script<std::optional<tmcl::Result<tmcl::Answer>>> GatewayBus::send_admitted(
    tmcl::step::Exchange exchange, Conduct& conduct) {
  auto& options = exchange.options;
  const auto given = earliest(options.deadline, conduct.options.deadline);
  options.deadline = earliest(given, admitted_until(exchange, conduct.options));
  const bool is_earlier = options.deadline != given;
  // As long as this lives, so does the conduct.
  const auto has_changed = std::make_shared<bool>(false);
  options.objection = [this, &conduct, exchange_is = exchange,
                       of = std::weak_ptr(has_changed)]() -> std::optional<tmcl::Error> {
    const auto verdict_changes = of.lock();
    if (!verdict_changes) return tmcl::bad_argument("the call has ended that asked for it");
    return last_objection(exchange_is, conduct.options, *verdict_changes);
  };
  auto answer = co_await send_once(std::move(exchange), conduct);
  const bool was_sent = answer || answer.error().outcome != tmcl::Outcome::not_sent;
  const bool expired = !was_sent && answer.error().code == tmcl::Errc::deadline_passed;
  if ((expired && is_earlier) || (!was_sent && *has_changed)) co_return std::nullopt;
  co_return std::optional(std::move(answer));
}

std::optional<tmcl::Error> GatewayBus::last_objection(const tmcl::step::Exchange& exchange,
                                                      const RunOptions& options,
                                                      bool& has_changed) const {
  const auto& request = exchange.request;
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

tmcl::Script<tmcl::Result<void>> GatewayBus::keep_limits(tmcl::Request request) {
  for (const auto& limits : limits_) co_await must(limits->check(request));
  co_return tmcl::Result<void>{};
}

tmcl::Script<tmcl::Result<tmcl::Answer>> GatewayBus::send_once(tmcl::step::Exchange exchange,
                                                               Conduct& conduct) {
  const auto request = exchange.request;
  conduct.module = watched_module(exchange);
  std::optional<OnItsWay> on_its_way;
  auto* module = find_module(request.address);
  if (moves(exchange)) on_its_way.emplace(motors_, module, request, conduct.options.permit);
  ModuleMarks::Mark change;
  if (intent_of(request).changes_coordinates)
    change = motors_.coordinate_changes().set(request.address);
  const auto before = motors_.before(request, conduct.options.permit, model_of(request.address));
  std::optional<StopOnItsWay> stop_on_its_way;
  conduct.owes_stop = false;
  if (is_stop(intent_of(request)))
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
  if (answer) owed_stops_.remove(request);
  if (conduct.owes_stop) say_that_it_is_owed(answer.error());
  if (conduct.owes_stop && module != nullptr) module->note(answer.error());
  if (on_its_way) on_its_way->note(answer);
  on_its_way.reset();
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

void GatewayBus::tell_setting(const tmcl::Request& request, const Motors::Before& before) const {
  const bool is_known = request.command == tmcl::Command::SAP;
  const bool sets =
      is_known || request.command == tmcl::Command::RSAP || request.command == tmcl::Command::AAP;
  const bool is_of_client = before.of.number != 0 && before.of.number != before.claimant.of.number;
  if (!sets || !is_of_client || !on_setting_) return;
  on_setting_({request.address, request.motor}, request.type,
              is_known ? std::optional(request.value) : std::nullopt);
}

// ---- stops that were not answered --------------------------------------------------------------

bool GatewayBus::owe(const tmcl::Request& stop) {
  if (closed_) return false;
  const bool is_news = !owed_stops_.has(stop);
  if (!owed_stops_.add(stop)) return false;
  const bool matters = motors_.may_move({stop.address, stop.motor});
  if (is_news && matters && journal_) spawn(executor_, Journal::write(journal_));
  return true;
}

bool GatewayBus::owe_first(tmcl::AnyScript& script) {
  const auto step = script.start(clock_.now());
  const auto* first = step ? std::get_if<tmcl::step::Exchange>(&*step) : nullptr;
  return first != nullptr && is_stop(intent_of(first->request)) && owe(first->request);
}

tmcl::Script<tmcl::Result<void>> GatewayBus::pay_stops(tmcl::ModuleAddress module) {
  for (const auto& stop : owed_stops_.of(module)) {
    // Another call may have sent it meanwhile.
    if (!owed_stops_.has(stop)) continue;
    Conduct conduct;
    auto answer = co_await send_once({stop, {}}, conduct);
    if (conduct.owes_stop) {
      answer.error().outcome = tmcl::Outcome::not_sent;
      co_return tl::unexpected(std::move(answer.error()));
    }
    owed_stops_.remove(stop);
    if (answer) tell_paid(stop);
  }
  co_return tmcl::Result<void>{};
}

awaitable<void> GatewayBus::pay_stops(std::shared_ptr<GatewayBus> self,
                                      tmcl::ModuleAddress module) {
  // Those that fail are kept for the next time.
  co_await self->run(self->pay_stops(module), {});
}

void GatewayBus::send_owed_stops(tmcl::ModuleAddress module) {
  if (owes_stop(module)) spawn(executor_, pay_stops(shared_from_this(), module));
}

void GatewayBus::tell_paid(const tmcl::Request& stop) {
  const tmcl::AxisAddress motor{stop.address, stop.motor};
  const auto by = motors_.claimant_of(motor).by;
  const bool is_led = by != Mover::nobody && by != Mover::search;
  if (stop.command != tmcl::Command::MST || is_led) return;
  GatewayEvent event{GatewayEvent::Kind::axis_stopped, config_.name, number(motor.module),
                     1 << motor.motor};
  event.text = "motor " + std::to_string(motor.motor) +
               " is stopped: its module has taken the stop that could not be sent before";
  event.cause = name_of(StopCause::client);
  emit(std::move(event));
}

void GatewayBus::note_answer(const tmcl::Request& request,
                             const tmcl::Result<tmcl::Answer>& answer) {
  auto* module = find_module(request.address);
  if (module != nullptr && answer) module->note_answer(request, *answer);
}

/// What is proven by another command behind it, is proven by the question of the sentinel.
tmcl::Script<tmcl::StepResult> GatewayBus::exchange_all(
    std::vector<tmcl::step::Exchange> exchanges) {
  if (exchanges.empty()) co_return std::vector<tmcl::Result<tmcl::Answer>>();
  const auto last = exchanges.back();
  auto* module = last.options.proof == tmcl::Proof::none ? nullptr : watched_module(last);
  const bool asks_more = module != nullptr && module->sentinel().watches();
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

namespace {

void charge(tmcl::step::Exchange& exchange, std::uint64_t client) {
  exchange.options.asker = client;
}

/// Charges the client with all that goes out for its verb: also with what is asked about others
/// before a request is let out.
tmcl::Script<tmcl::Result<void>> charged(tmcl::Script<tmcl::Result<void>> script,
                                         std::uint64_t client) {
  auto now = co_await tmcl::current_time();
  auto step = script.start(now);
  while (step) {
    tmcl::StepResult results;
    if (const auto* pause = std::get_if<tmcl::step::Pause>(&*step)) {
      co_await tmcl::pause(pause->duration);
    } else if (auto* one = std::get_if<tmcl::step::Exchange>(&*step)) {
      charge(*one, client);
      results.push_back(co_await tmcl::exchange(one->request, one->options));
    } else {
      auto& all = std::get<tmcl::step::ExchangeAll>(*step).exchanges;
      for (auto& each : all) charge(each, client);
      results = co_await tmcl::exchange_all(std::move(all));
    }
    now = co_await tmcl::current_time();
    step = script.resume(std::move(results), now);
  }
  co_return script.take();
}

}  // namespace

boost::asio::awaitable<GatewayBus::Ended> GatewayBus::run_steps(tmcl::AnyScript& script,
                                                                RunOptions options) {
  const auto bus = bus_;
  if (!bus) {
    auto error = not_open();
    if (owe_first(script)) say_that_it_is_owed(error);
    co_return Ended{std::move(error)};
  }
  // Steps of one verb all go to the link it began on: after a loss another module may be there.
  tmcl::RunOptions of_bus{options.deadline, {}, options.on_answer};
  of_bus.objection = [this, bus] { return bus == bus_ ? std::nullopt : std::optional(not_open()); };
  Conduct conduct{std::move(options)};
  co_await begin_turning(conduct);
  auto steps = charged(judged(script, conduct), conduct.options.permit.client);
  auto ended = co_await bus->run(std::move(steps), std::move(of_bus));
  if (!ended) {
    if (conduct.owes_stop) say_that_it_is_owed(ended.error());
    co_return Ended{std::move(ended.error()), false, std::move(conduct.turning)};
  }
  co_return Ended{std::nullopt, conduct.refused && conduct.acted, std::move(conduct.turning)};
}

tmcl::Script<tmcl::Result<void>> GatewayBus::judged(tmcl::AnyScript& script, Conduct& conduct) {
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

std::optional<tmcl::Error> GatewayBus::objection_to(const tmcl::Step& step,
                                                    const Conduct& conduct) {
  // What is judged is refused in send(), and a verb that was refused sets back what it has set.
  const auto* one = std::get_if<tmcl::step::Exchange>(&step);
  const bool goes_on = conduct.refused || (one != nullptr && moves(*one));
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

#include <limits>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/arrival.hpp"
#include "tmcl/relative_move.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;
using Verdict = plan::Arrival::Verdict;

Request axis_request(AxisAddress axis, Command command, std::uint8_t type, std::int32_t value = 0) {
  return {axis.module, command, type, axis.motor, value};
}

bool may_have_been_executed(const Result<Answer>& answer) {
  return !answer && answer.error().outcome == Outcome::unknown;
}

/// Looking moves nothing, so it says nothing about the axis that a look was not sent.
Error cannot_see(AxisAddress axis, Error error) {
  if (error.code != Errc::link_lost) return error;
  error.outcome = Outcome::unknown;
  error.message = fmt::format("it cannot be seen whether motor {} of module {} arrives: {}",
                              axis.motor, number(axis.module), error.message);
  error.hint = "it goes on with what it was told; wait again when the bus is open";
  return error;
}

Error interrupted(AxisAddress axis, const AxisState& state, Microsteps goal, std::string_view why) {
  Error error{Errc::move_interrupted, Outcome::done, {}, {}, {}, {}, {}};
  error.message =
      fmt::format("motor {} of module {} {} at {}, {} microsteps short of its target {}",
                  axis.motor, number(axis.module), why, state.position.value,
                  std::int64_t{goal.value} - state.position.value, goal.value);
  error.hint = "someone may have stopped it, or a limit switch did; move again when it is safe";
  return error;
}

/// `last`: how the axis was seen last, if there was time for that.
Error still_moving(AxisAddress axis, const std::optional<AxisState>& last) {
  Error error{Errc::deadline_passed, Outcome::done, {}, {}, {}, {}, {}};
  if (!last) {
    error.message =
        fmt::format("there was no time to see whether motor {} of module {} has arrived",
                    axis.motor, number(axis.module));
    error.hint = "wait longer; if it moves, it goes on moving";
    return error;
  }
  error.message =
      fmt::format("motor {} of module {} has not arrived yet: at {} on its way to {}", axis.motor,
                  number(axis.module), last->position.value, last->target.value);
  error.hint = "it goes on moving; wait longer or stop it";
  return error;
}

// A look that comes too late costs as much as one that comes too early, so what is predicted for
// now is looked at as if nothing were. `left`: until it should arrive; `look`: how long the last
// look took; the last of all is to end with the timeout.
Duration next_pause(const WaitOptions& options, Duration left, Duration waited, Duration look) {
  constexpr Duration shortest = std::chrono::milliseconds(1);
  constexpr Duration longest = std::chrono::seconds(1);
  const auto early = 2 * options.poll_interval;
  const auto pause =
      std::clamp(left - early, options.poll_interval, std::max(longest, options.poll_interval));
  if (options.timeout == Duration{}) return pause;
  return std::min(pause, std::max(options.timeout - waited - look, shortest));
}

Script<Result<AxisState>> look_at(AxisAddress axis, CallOptions options) {
  const auto read = [&](std::uint8_t parameter) {
    return ask(axis_request(axis, Command::GAP, parameter), options);
  };
  // The position last: when the axis had arrived, it is the place where it arrived.
  const auto reached = co_await must(read(ap::position_reached));
  const auto speed = co_await must(read(ap::actual_velocity));
  const auto target = co_await must(read(ap::target_position));
  const auto at = co_await must(read(ap::actual_position));
  co_return AxisState{Microsteps{at}, InternalVelocity{speed}, Microsteps{target}, reached != 0};
}

constexpr Duration mode_interval = std::chrono::milliseconds(500);
// A reading may be a little older than it seems: one with the old target proves nothing.
constexpr Duration sent_elsewhere_limit = std::chrono::milliseconds(200);

/// A stop is a turn at 0. False if that is unknown.
Script<bool> turns_by_velocity(AxisAddress axis, const WaitOptions& options, CallOptions call) {
  if (!options.goal || !options.mode) co_return false;
  const auto mode = co_await ask(axis_request(axis, Command::GAP, options.mode->number), call);
  co_return mode == options.mode->velocity;
}

/// Why an axis will not come to its goal; empty as long as it may.
std::string interruption(Verdict verdict, const AxisState& state) {
  if (verdict == Verdict::stands_elsewhere) return "stands still";
  if (verdict == Verdict::sent_elsewhere)
    return fmt::format("was sent to {} instead,", state.target.value);
  return {};
}

plan::Arrival::Reading reading_of(const AxisState& state, TimePoint at) {
  return {at, state.position, state.target, state.velocity.value == 0, state.position_reached};
}

/// The same, proven: the next step depends on it.
Script<Result<AxisState>> look_again(AxisAddress axis, CallOptions options) {
  const std::vector<std::uint8_t> parameters{ap::position_reached, ap::actual_velocity,
                                             ap::target_position, ap::actual_position};
  const auto values = co_await must(get_all(axis, parameters, options));
  co_return AxisState{Microsteps{values[3]}, InternalVelocity{values[1]}, Microsteps{values[2]},
                      values[0] != 0};
}

}  // namespace

Script<Result<Answer>> command(Request request, CallOptions options) {
  co_return co_await exchange(request, options);
}

Script<Result<std::int32_t>> get(AxisAddress axis, std::uint8_t parameter) {
  return ask(axis_request(axis, Command::GAP, parameter));
}

Script<Result<std::vector<std::int32_t>>> get_all(AxisAddress axis,
                                                  std::vector<std::uint8_t> parameters,
                                                  CallOptions options) {
  std::vector<step::Exchange> reads;
  for (const auto parameter : parameters) {
    reads.push_back(
        {axis_request(axis, Command::GAP, parameter), with_proof(Proof::followed, options)});
  }
  const auto answers = co_await exchange_all(std::move(reads));
  std::vector<std::int32_t> values;
  for (const auto& answer : answers) {
    if (!answer) co_return tl::unexpected(answer.error());
    values.push_back(answer->reply.value);
  }
  co_return values;
}

Script<Result<void>> set(AxisAddress axis, std::uint8_t parameter, std::int32_t value) {
  const auto request = axis_request(axis, Command::SAP, parameter, value);
  auto answer = co_await exchange(request);
  if (may_have_been_executed(answer) && effect_of(Command::SAP, parameter) != Effect::moves) {
    const auto present = co_await get(axis, parameter);
    if (present && *present == value) co_return Result<void>{};
    // The module answers again and holds another value: the request was lost, so it may be sent
    // anew.
    if (present) answer = co_await exchange(request);
  }
  if (!answer) co_return tl::unexpected(answer.error());
  co_return Result<void>{};
}

Script<Result<void>> store(AxisAddress axis, std::uint8_t parameter) {
  return act(axis_request(axis, Command::STAP, parameter));
}

Script<Result<void>> restore(AxisAddress axis, std::uint8_t parameter) {
  return act(axis_request(axis, Command::RSAP, parameter));
}

Script<Result<ParameterRange>> parameter_range(AxisAddress axis, std::uint8_t parameter) {
  const auto least = co_await must(ask(axis_request(axis, Command::GET_AP_MIN, parameter)));
  const auto greatest = co_await must(ask(axis_request(axis, Command::GET_AP_MAX, parameter)));
  co_return ParameterRange{least, greatest};
}

Script<Result<std::int32_t>> get_global(ModuleAddress module, std::uint8_t bank,
                                        std::uint8_t parameter) {
  return ask({module, Command::GGP, parameter, bank, 0});
}

Script<Result<Microsteps>> move_to(AxisAddress axis, Microsteps target) {
  co_await must(act(axis_request(axis, Command::MVP, move_type::absolute, target.value)));
  co_return target;
}

Script<Result<Microsteps>> proven_position(AxisAddress axis) {
  const auto read = axis_request(axis, Command::GAP, ap::actual_position);
  const auto here = co_await must(ask(read, with_proof(Proof::twice)));
  co_return Microsteps{here};
}

Script<Result<Microsteps>> move_from_here(AxisAddress axis, Destination destination) {
  const auto here = co_await proven_position(axis);
  if (!here) {
    auto error = here.error();
    error.outcome = Outcome::not_sent;
    co_return tl::unexpected(std::move(error));
  }
  auto there = destination(*here);
  if (!there) co_return there;
  co_return co_await move_to(axis, *there);
}

Script<Result<Microsteps>> move_by(AxisAddress axis, Microsteps distance) {
  return move_from_here(axis, [distance](Microsteps here) -> Result<Microsteps> {
    const auto target = std::int64_t{here.value} + distance.value;
    if (target >= std::numeric_limits<std::int32_t>::min() &&
        target <= std::numeric_limits<std::int32_t>::max())
      return Microsteps{static_cast<std::int32_t>(target)};
    return tl::unexpected(
        bad_argument(fmt::format("{} microsteps from {} is beyond every position a module has",
                                 distance.value, here.value)));
  });
}

Script<Result<void>> rotate(AxisAddress axis, InternalVelocity velocity) {
  // The least int32 has no positive counterpart; no module turns that fast anyway.
  const auto speed = std::max(velocity.value, -std::numeric_limits<std::int32_t>::max());
  if (speed >= 0) return act(axis_request(axis, Command::ROR, 0, speed));
  return act(axis_request(axis, Command::ROL, 0, -speed));
}

Script<Result<void>> stop(AxisAddress axis) { return act(axis_request(axis, Command::MST, 0)); }

Script<Result<Microsteps>> position(AxisAddress axis) {
  const auto value = co_await must(get(axis, ap::actual_position));
  co_return Microsteps{value};
}

Script<Result<InternalVelocity>> velocity(AxisAddress axis) {
  const auto value = co_await must(get(axis, ap::actual_velocity));
  co_return InternalVelocity{value};
}

Script<Result<AxisState>> state(AxisAddress axis) { return look_at(axis, {}); }

Script<Result<Microsteps>> wait_until_reached(AxisAddress axis, WaitOptions options) {
  const auto begin = co_await current_time();
  const auto call = until_timeout(begin, options.timeout);
  plan::Arrival arrival(options.goal, begin, {options.standstill_limit, sent_elsewhere_limit});
  auto mode_asked_at = begin;
  std::optional<AxisState> last;
  std::optional<TimePoint> steady_since;
  while (true) {
    const auto look_begin = co_await current_time();
    const auto now = co_await look_at(axis, call);
    if (!now && is_too_late(call, now.error())) co_return tl::unexpected(still_moving(axis, last));
    if (!now) co_return tl::unexpected(cannot_see(axis, now.error()));
    last = *now;
    const auto time = co_await current_time();
    const auto verdict = arrival.judge(reading_of(*now, time));
    bool stands_there = verdict == Verdict::arrived;
    if (stands_there) {
      const auto sure = co_await look_again(axis, call);
      stands_there = sure && arrival.judge(reading_of(*sure, time)) == Verdict::arrived;
      if (stands_there && time - steady_since.value_or(time) >= options.steady)
        co_return sure->position;
    }
    steady_since = stands_there ? std::optional(steady_since.value_or(time)) : std::nullopt;
    const auto goal = options.goal.value_or(now->target);
    auto why = interruption(verdict, *now);
    if (why.empty() && time - mode_asked_at >= mode_interval) {
      mode_asked_at = time;
      if (co_await turns_by_velocity(axis, options, call))
        why = "was stopped, or turned by velocity,";
    }
    if (!why.empty()) co_return tl::unexpected(interrupted(axis, *now, goal, why));
    if (is_over(call, time)) co_return tl::unexpected(still_moving(axis, last));
    // Whether it will arrive at all is to be known soon.
    const bool is_doubtful = now->velocity.value == 0 || now->target != goal;
    const auto left = is_doubtful ? Duration{} : options.expected - (time - begin);
    co_await pause(next_pause(options, left, time - begin, time - look_begin));
  }
}

}  // namespace tmcl::verbs

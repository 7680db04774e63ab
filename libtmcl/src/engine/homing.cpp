#include "tmcl/homing.hpp"

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

constexpr auto search_mode = number_of("reference_search_mode");
constexpr auto switch_distance = number_of("reference_switch_distance");
constexpr auto position_before_zeroing = number_of("last_reference_position");

Request search_request(AxisAddress axis, std::uint8_t type) {
  return {axis.module, Command::RFS, type, axis.motor, 0};
}

/// `step`: the last that was seen, if there was time for that.
Error still_searching(AxisAddress axis, std::optional<std::int32_t> step) {
  Error error{Errc::deadline_passed, Outcome::done, {}, {}, {}, {}, {}};
  error.message = fmt::format("motor {} of module {} has not found its reference yet", axis.motor,
                              number(axis.module));
  if (step) error.message += fmt::format(": step {}", *step);
  error.hint =
      "the search goes on; wait longer, or stop it and check the switches and parameter 193";
  return error;
}

/// What is asked after the search has begun says nothing of whether that was sent.
Error since_begin(Error error, Outcome of_search) {
  error.outcome = of_search;
  return error;
}

/// Silence counts as an answer until there has been too much of it, or the time is over.
Script<Result<std::int32_t>> patient_status(AxisAddress axis, HomeOptions options,
                                            CallOptions call) {
  // In pauses: after several lost answers the bus itself asks nothing for some seconds.
  Duration silent{};
  while (true) {
    auto step = co_await ask(search_request(axis, search_type::status), call);
    const auto now = co_await current_time();
    const bool patient = silent < options.silence_limit && !is_over(call, now);
    if (step || !is_silence(step.error()) || !patient) co_return step;
    co_await pause(within_deadline(call, now, options.poll_interval));
    silent += options.poll_interval;
  }
}

Script<Result<void>> start_search(AxisAddress axis, CallOptions call) {
  auto started = co_await act(search_request(axis, search_type::start), call);
  if (started || started.error().outcome != Outcome::unknown) co_return started;
  const auto step = co_await ask(search_request(axis, search_type::status), call);
  if (step && *step != 0) co_return Result<void>{};
  co_return started;
}

Script<Result<std::optional<Microsteps>>> get_if_there(AxisAddress axis, std::uint8_t parameter) {
  const auto value = co_await must(unless_refused(get(axis, parameter)));
  co_return value ? std::optional(Microsteps{*value}) : std::nullopt;
}

/// Modules take any mode, and refuse only the search. The mode of a search that did not begin must
/// not stay: each later search would be one in that mode, or be refused.
Script<Result<void>> start_search_in(AxisAddress axis, std::int32_t mode, CallOptions call) {
  const auto before = co_await must(unless_refused(get(axis, search_mode)));
  co_await must(set(axis, search_mode, mode));
  auto started = co_await start_search(axis, call);
  const bool may_have_begun = started || started.error().outcome == Outcome::unknown;
  if (may_have_begun || !before) co_return started;
  const auto set_back = co_await set(axis, search_mode, *before);
  if (started.error().outcome != Outcome::refused) co_return started;
  started.error().hint = fmt::format(
      "Mode {} is perhaps none that this module has. Parameter {} {}", mode, search_mode,
      set_back ? fmt::format("is {} again, as before", *before) : "could not be set back");
  co_return started;
}

Script<Result<void>> start_search(AxisAddress axis, std::optional<std::int32_t> mode,
                                  CallOptions call) {
  return mode ? start_search_in(axis, *mode, call) : start_search(axis, call);
}

/// Those that go from one end switch to the other; with 64 added, the sides are swapped.
bool visits_both_ends(std::int32_t mode) {
  constexpr std::int32_t swapped = 64;
  const auto number = mode & ~swapped;
  return number == 2 || number == 3;
}

/// The mode that it searches in; nothing where the module has one only.
Script<Result<std::optional<std::int32_t>>> mode_of(AxisAddress axis,
                                                    std::optional<std::int32_t> given) {
  if (given) co_return given;
  auto held = co_await unless_refused(get(axis, search_mode));
  co_return held;
}

/// What it has measured. A search that has found its reference has made that zero, and the axis
/// stands there; one that was stopped has measured nothing, and the values are of another.
Script<Result<Homed>> measured(AxisAddress axis, std::optional<std::int32_t> given) {
  Homed homed;
  const auto here = co_await must(get(axis, axis_parameter::actual_position));
  if (here != 0) co_return homed;
  homed.correction = co_await must(get_if_there(axis, position_before_zeroing));
  const auto mode = co_await must(mode_of(axis, given));
  if (mode && visits_both_ends(*mode))
    homed.switch_distance = co_await must(get_if_there(axis, switch_distance));
  co_return homed;
}

/// Asked when the status says so: what the next step depends on is read twice.
Script<Result<bool>> has_ended(AxisAddress axis, CallOptions call) {
  const auto status = search_request(axis, search_type::status);
  const auto step = co_await must(ask(status, with_proof(Proof::twice, call)));
  co_return step == 0;
}

}  // namespace

Script<Result<void>> start_reference_search(AxisAddress axis, std::optional<std::int32_t> mode) {
  return start_search(axis, mode, {});
}

Script<Result<void>> stop_reference_search(AxisAddress axis) {
  return act(search_request(axis, search_type::stop));
}

Script<Result<std::int32_t>> reference_search_status(AxisAddress axis) {
  return ask(search_request(axis, search_type::status));
}

Script<Result<Homed>> home(AxisAddress axis, HomeOptions options) {
  const auto begin = co_await current_time();
  const auto call = until_timeout(begin, options.timeout);
  co_await must(start_search(axis, options.mode, call));
  std::optional<std::int32_t> last;
  while (true) {
    const auto step = co_await patient_status(axis, options, call);
    const auto now = co_await current_time();
    const bool late = is_over(call, now);
    if (!step && (is_too_late(call, step.error()) || (late && is_silence(step.error()))))
      co_return tl::unexpected(still_searching(axis, last));
    if (!step) co_return tl::unexpected(since_begin(step.error(), Outcome::unknown));
    if (*step == 0) {
      const auto ended = co_await has_ended(axis, call);
      if (ended && *ended) break;
    }
    last = *step;
    const bool wanted = !options.progress || options.progress(*step);
    if (!wanted || late) co_return tl::unexpected(still_searching(axis, last));
    co_await pause(within_deadline(call, now, options.poll_interval));
  }
  auto homed = co_await measured(axis, options.mode);
  if (!homed) co_return tl::unexpected(since_begin(homed.error(), Outcome::done));
  co_return homed;
}

}  // namespace tmcl::verbs

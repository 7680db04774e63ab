#include "tmcl/homing.hpp"

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/verbs.hpp"

namespace tmcl::verbs {
namespace {

constexpr std::uint8_t search_mode = 193;
constexpr std::uint8_t switch_distance = 196;
constexpr std::uint8_t position_before_zeroing = 197;
enum class Search : std::uint8_t { start = 0, stop = 1, status = 2 };

Request search_request(AxisAddress axis, Search what) {
  return {axis.module, Command::RFS, static_cast<std::uint8_t>(what), axis.motor, 0};
}

Error still_searching(AxisAddress axis, std::int32_t step) {
  Error error{Errc::deadline_passed, Outcome::done, {}, {}, {}, {}, {}};
  error.message = fmt::format("motor {} of module {} has not found its reference yet: step {}",
                              axis.motor, number(axis.module), step);
  error.hint =
      "the search goes on; wait longer, or stop it and check the switches and parameter 193";
  return error;
}

/// Silence counts as an answer until there has been too much of it.
Script<Result<std::int32_t>> patient_status(AxisAddress axis, HomeOptions options) {
  Duration silent{};
  while (true) {
    const auto step = co_await reference_search_status(axis);
    if (step || !is_silence(step.error()) || silent >= options.silence_limit) co_return step;
    co_await pause(options.poll_interval);
    silent += options.poll_interval;
  }
}

Script<Result<std::optional<Microsteps>>> get_if_there(AxisAddress axis, std::uint8_t parameter) {
  const auto value = co_await get(axis, parameter);
  if (value) co_return std::optional(Microsteps{*value});
  if (value.error().outcome == Outcome::refused) co_return std::optional<Microsteps>{};
  co_return tl::unexpected(value.error());
}

}  // namespace

Script<Result<void>> start_reference_search(AxisAddress axis) {
  const auto started = co_await act(search_request(axis, Search::start));
  if (started || started.error().outcome != Outcome::unknown) co_return started;
  const auto step = co_await reference_search_status(axis);
  if (step && *step != 0) co_return Result<void>{};
  co_return started;
}

Script<Result<void>> stop_reference_search(AxisAddress axis) {
  return act(search_request(axis, Search::stop));
}

Script<Result<std::int32_t>> reference_search_status(AxisAddress axis) {
  return ask(search_request(axis, Search::status));
}

Script<Result<Homed>> home(AxisAddress axis, HomeOptions options) {
  if (options.mode) {
    const auto chosen = co_await set(axis, search_mode, *options.mode);
    if (!chosen) co_return tl::unexpected(chosen.error());
  }
  const auto started = co_await start_reference_search(axis);
  if (!started) co_return tl::unexpected(started.error());
  for (Duration waited{};; waited += options.poll_interval) {
    const auto step = co_await patient_status(axis, options);
    if (!step) co_return tl::unexpected(step.error());
    if (*step == 0) break;
    const bool wanted = !options.progress || options.progress(*step);
    const bool late = options.timeout > Duration{} && waited >= options.timeout;
    if (!wanted || late) co_return tl::unexpected(still_searching(axis, *step));
    co_await pause(options.poll_interval);
  }
  const auto correction = co_await get_if_there(axis, position_before_zeroing);
  if (!correction) co_return tl::unexpected(correction.error());
  const auto distance = co_await get_if_there(axis, switch_distance);
  if (!distance) co_return tl::unexpected(distance.error());
  co_return Homed{*correction, *distance};
}

}  // namespace tmcl::verbs

#include "tmcl/readings_at_rest.hpp"

#include <cmath>

#include <fmt/format.h>

#include "engine/verb_steps.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl::verbs {
namespace {

namespace ap = axis_parameter;

// An axis that arrives earlier is seen to stand by then.
constexpr Duration before_arrival = std::chrono::milliseconds(30);
constexpr double uneven_part = 0.5;  // of the time from one reading to the next

Request reading(AxisAddress axis, std::uint8_t parameter) {
  return {axis.module, Command::GAP, parameter, axis.motor, 0};
}

Error not_there(AxisAddress axis) {
  Error error{Errc::deadline_passed, Outcome::done, {}, {}, {}, {}, {}};
  error.message = fmt::format("motor {} of module {} has not come to its target in time",
                              axis.motor, number(axis.module));
  error.hint = "something may have stopped it, or it swings about its target; move it again";
  return error;
}

/// It may be at its target in passing only.
Script<Result<bool>> stands(AxisAddress axis, CallOptions options) {
  const auto reached =
      co_await must(ask(reading(axis, ap::position_reached), with_proof(Proof::followed, options)));
  if (reached == 0) co_return false;
  const auto speed = co_await must(ask(reading(axis, ap::actual_velocity), options));
  co_return speed == 0;
}

/// Spread evenly, and no two of them in a row alike.
Duration uneven(std::size_t count, Duration interval) {
  constexpr double golden = 0.6180339887498949;
  const double part = static_cast<double>(count) * golden;
  return std::chrono::duration_cast<Duration>((part - std::floor(part)) * uneven_part * interval);
}

}  // namespace

Script<Result<std::vector<ReadingAt>>> read_at_rest(AxisAddress axis, RestReadings wanted) {
  const auto begin = co_await current_time();
  const auto options = until_timeout(begin, wanted.timeout);
  if (wanted.expected > before_arrival) co_await pause(wanted.expected - before_arrival);
  while (true) {
    const auto there = co_await stands(axis, options);
    if (!there && is_too_late(options, there.error())) co_return tl::unexpected(not_there(axis));
    if (!there) co_return tl::unexpected(there.error());
    if (*there) break;
    if (is_over(options, co_await current_time())) co_return tl::unexpected(not_there(axis));
  }
  std::vector<ReadingAt> readings;
  const auto first = co_await current_time();
  const auto least_interval = wanted.span / static_cast<Duration::rep>(wanted.most);
  while (readings.size() < wanted.most) {
    const auto answer = co_await must(exchange(reading(axis, wanted.parameter)));
    const auto taken = answer.received - answer.sent;
    readings.push_back({answer.sent + taken / 2, answer.reply.value});
    const auto passed = co_await current_time() - first;
    if (passed >= wanted.span) break;
    const auto count = static_cast<Duration::rep>(readings.size());
    const auto early = std::max(count * least_interval - passed, Duration{});
    co_await pause(early + uneven(readings.size(), std::max(taken, least_interval)));
  }
  co_return readings;
}

}  // namespace tmcl::verbs

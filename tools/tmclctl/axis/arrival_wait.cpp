#include "arrival_wait.hpp"

#include <algorithm>
#include <cctype>
#include <csignal>

#include <fmt/format.h>

#include "gateway/axis/stop_advice.hpp"
#include "output/print.hpp"

namespace tmclctl {
namespace {

std::string goal_text(const Journey& journey) {
  return shown(journey.goal_in_unit, journey.goal.value);
}

Error not_reached(const Journey& journey, const AxisReading& reading, std::string_view what,
                  std::string hint) {
  Error failure{"move_interrupted", ErrorKind::ended_early, tmcl::Outcome::done,
                fmt::format("{} {}: at {}, on its way to {}", journey.axis, what,
                            position_text(reading, !journey.goal_in_unit), goal_text(journey)),
                std::move(hint)};
  failure.subject = {{"axis", journey.axis},
                     {"position_microsteps", reading.position_microsteps},
                     {"target_microsteps", journey.goal.value}};
  if (journey.goal_in_unit && reading.position) {
    failure.subject["unit"] = journey.goal_in_unit->unit;
    failure.subject["position"] = *reading.position;
    failure.subject["target"] = journey.goal_in_unit->value;
  }
  return failure;
}

Error move_interrupted(const Journey& journey, const AxisReading& reading) {
  // What is known comes first: a stopped axis is in velocity mode, and may still slow down.
  if (reading.stop_cause) {
    auto failure = not_reached(journey, reading,
                               reading.moving ? "is being stopped short of its target"
                                              : "stands still short of its target",
                               advice_on_stop(journey.axis, *reading.stop_cause));
    failure.message += "; cause: " + *reading.stop_cause;
    failure.subject["stop_cause"] = *reading.stop_cause;
    return failure;
  }
  if (reading.target_microsteps != journey.goal.value) {
    return not_reached(
        journey, reading,
        fmt::format("was sent to {} instead", target_text(reading, !journey.goal_in_unit)),
        "Another program moves the same axis");
  }
  if (reading.moving) {
    return not_reached(journey, reading, "is turned by velocity",
                       "Another program moves the same axis");
  }
  return not_reached(journey, reading, "stands still short of its target",
                     fmt::format("Why is not known: 'tmclctl errors {}' shows its flags and "
                                 "switches",
                                 journey.axis));
}

Error lost_sight(const Journey& journey, Error failure, const Context& context) {
  // The move itself was accepted; where it ended is not known.
  failure.kind = ErrorKind::failed;
  failure.outcome = tmcl::Outcome::done;
  failure.name = "lost_sight";
  failure.message = fmt::format("lost sight of {} on its way to {}: {}", journey.axis,
                                goal_text(journey), failure.message);
  failure.hint = "It may still be moving. " + how_to_stop(journey.axis, context);
  return failure;
}

/// `reading`: how the axis was seen last.
Error explained(const Journey& journey, const AxisReading& reading, Error failure,
                Context& context) {
  if (context.host.signal() != 0) {
    return interrupted_error(
        context.host.signal(),
        fmt::format("no longer waiting; {} goes on moving to {}", journey.axis, goal_text(journey)),
        how_to_stop(journey.axis, context), not_reached(journey, reading, "", "").subject);
  }
  if (failure.name == name_of(tmcl::Errc::deadline_passed)) {
    auto late = not_reached(journey, reading, "has not arrived in time",
                            "It goes on moving. " + how_to_stop(journey.axis, context));
    late.name = "timeout";
    return late;
  }
  const bool has_arrived = failure.name == tmcl::client::error_name::driver_fault ||
                           failure.name == tmcl::client::error_name::not_in_position;
  if (has_arrived) return failure;
  if (exit_code_of(failure) == ExitCode::not_reached) return move_interrupted(journey, reading);
  return lost_sight(journey, std::move(failure), context);
}

}  // namespace

std::optional<Error> interrupted_before_move(Context& context) {
  if (context.host.signal() == 0) return std::nullopt;
  auto failure = interrupted_error(context.host.signal(), "interrupted before anything moved", "");
  failure.outcome = tmcl::Outcome::not_sent;
  return failure;
}

std::string advice_on_stop(const std::string& axis, const std::string& cause) {
  std::string advice(tmcld::advice_on(cause));
  if (!advice.empty()) {
    advice[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(advice[0])));
    advice += ". ";
  }
  return advice + fmt::format("'tmclctl errors {}' shows its flags and switches", axis);
}

std::string how_to_stop(const std::string& axis, const Context& context) {
  return fmt::format("Stop it with: tmclctl{} stop {}", context.output.gateway, axis);
}

Result<tmcl::api::axis::StartedMove> start_move(const std::string& axis, const Typed& where,
                                                bool by, Context& context) {
  using namespace tmcl::api::axis;
  if (by) return context.call(MoveBy{axis, where.counted(), where.amount(), {}, move_deadline_ms});
  return context.call(MoveTo{axis, where.counted(), where.amount(), {}, move_deadline_ms});
}

Result<Warnings> follow(const Journey& journey, Context& context,
                        const std::function<void(const AxisReading&)>& on_reading) {
  Wait wait{journey.axis, journey.goal, journey.interval, {}, journey.beside, journey.meanwhile};
  // Nothing left is no time limit, to a gateway.
  if (journey.timeout) {
    const auto passed = context.host.now() - journey.started_at;
    wait.at_most = std::max<tmcl::Duration>(*journey.timeout - passed, shortest_wait);
  }
  AxisReading last;
  auto stands = wait_for(
      wait,
      [&](const AxisReading& reading) {
        const auto& others = journey.beside.axes;
        if (std::ranges::find(others, reading.axis) == others.end()) last = reading;
        on_reading(reading);
      },
      context);
  if (stands) return stands;
  return tl::unexpected(explained(journey, last, std::move(stands.error()), context));
}

}  // namespace tmclctl

#include "following.hpp"

#include <csignal>

#include <fmt/format.h>

#include "json_read.hpp"
#include "print.hpp"
#include "tmcl/plan/arrival.hpp"

namespace tmclctl {
namespace {

using tmcl::plan::Arrival;

// A reading may be a little older than it seems: one with the old target proves nothing.
constexpr tmcl::Duration sent_elsewhere_limit = std::chrono::milliseconds(200);

constexpr int staying_limit_ms = 500;

// By name: only where there is a parameter of this name, 2 is the mode after a stop and while
// turning by velocity.
constexpr const char* ramp_mode = "ramp_mode";
constexpr std::int32_t velocity_mode = 2;
constexpr tmcl::Duration mode_interval = std::chrono::milliseconds(500);

std::string goal_text(const Journey& journey) {
  return shown(journey.goal_in_unit, journey.goal.value);
}

Failure not_reached(const Journey& journey, const AxisReading& reading, std::string_view what,
                    std::string hint) {
  Failure failure{
      ExitCode::not_reached, "move_interrupted", {}, std::move(hint), tmcl::Outcome::done};
  failure.message = fmt::format("{} {}: at {}, on its way to {}", journey.axis, what,
                                position_text(reading, !journey.goal_in_unit), goal_text(journey));
  failure.details = {{"axis", journey.axis},
                     {"position_microsteps", reading.position.value},
                     {"target_microsteps", journey.goal.value}};
  if (journey.goal_in_unit && reading.user) {
    failure.details["unit"] = journey.goal_in_unit->unit;
    failure.details["position"] = reading.user->position;
    failure.details["target"] = journey.goal_in_unit->value;
  }
  return failure;
}

std::optional<Failure> ended_by_axis(const Journey& journey, const AxisReading& reading,
                                     Arrival::Verdict verdict) {
  if (verdict == Arrival::Verdict::stands_elsewhere) {
    return not_reached(journey, reading, "stands still short of its target",
                       "Someone may have stopped it, or a limit switch did: 'tmclctl params " +
                           journey.axis + " --values' shows the switches");
  }
  if (verdict == Arrival::Verdict::sent_elsewhere) {
    return not_reached(
        journey, reading,
        fmt::format("was sent to {} instead", target_text(reading, !journey.goal_in_unit)),
        "Another program moves the same axis");
  }
  return std::nullopt;
}

bool turns_by_velocity(const Journey& journey, Target& target) {
  const auto mode = target.get(journey.axis, ramp_mode);
  return mode && mode->value == velocity_mode;
}

Failure lost_sight(const Journey& journey, Failure failure, const Target& target) {
  failure.exit = ExitCode::unknown;
  // The move itself was accepted; where it ended nobody knows.
  failure.outcome.reset();
  failure.name = "lost_sight";
  failure.message = fmt::format("lost sight of {} on its way to {}: {}", journey.axis,
                                goal_text(journey), failure.message);
  failure.hint = "It may still be moving. " + how_to_stop(journey.axis, target);
  return failure;
}

std::optional<Failure> ended_by_user(const Journey& journey, const AxisReading& reading,
                                     Context& context) {
  if (context.host.signal() != 0) {
    auto failure = interrupted_failure(
        context.host.signal(),
        fmt::format("no longer waiting; {} goes on moving to {}", journey.axis, goal_text(journey)),
        how_to_stop(journey.axis, context.target));
    failure.details = not_reached(journey, reading, "", "").details;
    return failure;
  }
  if (journey.timeout && context.host.now() - journey.started_at >= *journey.timeout) {
    auto failure = not_reached(journey, reading, "has not arrived in time",
                               "It goes on moving. " + how_to_stop(journey.axis, context.target));
    failure.name = "timeout";
    return failure;
  }
  return std::nullopt;
}

/// Standing at its goal now, it may only be passing it: its gateway knows. Nothing while it does.
Attempt<std::optional<Warnings>> stays(const Journey& journey, Target& target) {
  const auto stands =
      target.perform("axis.wait", {{"axis", journey.axis}, {"timeout_ms", staying_limit_ms}}, {});
  if (!stands && stands.error().name == "deadline_passed") return std::nullopt;
  if (!stands && stands.error().exit == ExitCode::not_reached)
    return tl::unexpected(stands.error());
  if (!stands) return tl::unexpected(lost_sight(journey, stands.error(), target));
  return texts_at(*stands, "warnings");
}

}  // namespace

Failure interrupted_failure(int signal, const std::string& message, const std::string& hint) {
  const auto exit = signal == SIGTERM ? ExitCode::terminated : ExitCode::interrupted;
  return {exit, "interrupted", message, hint, tmcl::Outcome::done};
}

std::optional<Failure> interrupted_before_move(Context& context) {
  if (context.host.signal() == 0) return std::nullopt;
  auto failure =
      interrupted_failure(context.host.signal(), "interrupted before anything moved", "");
  failure.outcome = tmcl::Outcome::not_sent;
  return failure;
}

std::string how_to_stop(const std::string& axis, const Target& target) {
  return fmt::format("Stop it with: tmclctl{} stop {}", target.options(), axis);
}

Attempt<Warnings> follow(const Journey& journey, Context& context,
                         const std::function<void(const AxisReading&)>& on_reading) {
  Arrival arrival(journey.goal, journey.started_at, {standstill_limit, sent_elsewhere_limit});
  auto mode_asked_at = context.host.now();
  while (true) {
    const auto next_look = context.host.now() + journey.interval;
    const auto reading = context.target.state(journey.axis);
    // A signal ends the daemon's call, too, and then says more than the call's own error.
    if (!reading && context.host.signal() == 0) {
      return tl::unexpected(lost_sight(journey, reading.error(), context.target));
    }
    if (reading) {
      on_reading(*reading);
      const auto verdict =
          arrival.judge({reading->taken_at, reading->position, reading->target,
                         reading->velocity.value == 0, reading->position == reading->target});
      if (verdict == Arrival::Verdict::arrived && context.host.signal() == 0) {
        auto stands = stays(journey, context.target);
        if (!stands && context.host.signal() == 0) return tl::unexpected(std::move(stands.error()));
        if (stands && *stands) return std::move(**stands);
      }
      if (auto end = ended_by_axis(journey, *reading, verdict)) return tl::unexpected(*end);
    }
    if (auto end = ended_by_user(journey, reading.value_or(AxisReading{}), context))
      return tl::unexpected(*end);
    if (context.host.now() - mode_asked_at >= mode_interval) {
      mode_asked_at = context.host.now();
      if (turns_by_velocity(journey, context.target)) {
        return tl::unexpected(not_reached(journey, reading.value_or(AxisReading{}),
                                          "was stopped, or turned by velocity",
                                          "Someone else may have stopped it"));
      }
    }
    context.target.sleep(next_look - context.host.now());
  }
}

}  // namespace tmclctl

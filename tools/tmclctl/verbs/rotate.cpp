// rotate.
#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

constexpr tmcl::Duration turning_interval = std::chrono::milliseconds(100);

void print_turning(const verb::Rotate& verb, const api::axis::Turning& turning,
                   const std::string& how_to_stop, Output& output) {
  if (output.json) {
    return print_json({{"axis", verb.axis},
                       {"velocity_internal", turning.velocity_internal},
                       {"unit", api::write_value(turning.unit)},
                       {"velocity", api::write_value(turning.velocity)}},
                      output);
  }
  const auto speed =
      verb.internal ? std::nullopt : in_unit_a_second(turning.velocity, turning.unit);
  output.out << fmt::format("{} turns with velocity {}. {}", verb.axis,
                            shown(speed, turning.velocity_internal), how_to_stop)
             << std::endl;
}

/// Until a signal comes; or how it was seen when it had come to stand before.
Result<std::optional<AxisReading>> watch_turning(const verb::Rotate& verb, Context& context) {
  ProgressLine line(context.output);
  bool has_turned = false;
  std::optional<AxisReading> stands;
  const auto watched = watch(
      verb.axis, turning_interval,
      [&](const AxisReading* reading) {
        if (reading != nullptr) {
          if (has_turned && !reading->moving) stands = *reading;
          has_turned = has_turned || reading->moving;
          line.show(fmt::format("{} at {}  velocity {}", verb.axis,
                                position_text(*reading, verb.internal),
                                velocity_text(*reading, verb.internal)));
        }
        return context.host.signal() == 0 && !stands;
      },
      context);
  if (!watched && context.host.signal() == 0) return tl::unexpected(watched.error());
  return stands;
}

Error stopped_elsewhere(const std::string& axis, const AxisReading& stands) {
  Error failure{"move_interrupted", ErrorKind::ended_early, tmcl::Outcome::done,
                axis + " does not turn any more: it was not stopped here",
                advice_on_stop(axis, stands.stop_cause.value_or(""))};
  if (!stands.stop_cause) return failure;
  failure.message += "; cause: " + *stands.stop_cause;
  failure.subject["stop_cause"] = *stands.stop_cause;
  return failure;
}

/// `why` it is not known that it stands.
Error may_still_turn(const std::string& axis, Error why, const Context& context) {
  // That it turns is known; what its stop has come to is not.
  why.kind = ErrorKind::failed;
  why.outcome = tmcl::Outcome::done;
  why.message = fmt::format("{} may still turn: {}", axis, why.message);
  why.hint = how_to_stop(axis, context);
  return why;
}

Result<ExitCode> attend(const verb::Rotate& verb, Context& context) {
  const auto stands = watch_turning(verb, context);
  context.host.take_signal();
  if (stands && *stands) return tl::unexpected(stopped_elsewhere(verb.axis, **stands));
  const auto stopped = context.call(api::axis::Stop{verb.axis});
  if (!stopped) return tl::unexpected(may_still_turn(verb.axis, stopped.error(), context));
  if (!stands) return tl::unexpected(stands.error());
  if (!context.output.json) context.output.out << verb.axis << " stops\n";
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Rotate& verb, Context& context) {
  const Typed velocity{verb.velocity, verb.internal};
  const auto turning = context.call(api::axis::Rotate{
      verb.axis, velocity.counted(), velocity.amount(), verb.unattended, move_deadline_ms});
  if (!turning) return tl::unexpected(turning.error());
  warn(turning->warnings.value_or(Warnings()), context.output);
  const bool attends = !verb.unattended && turning->velocity_internal != 0;
  print_turning(verb, *turning, attends ? "Ctrl-C stops it" : how_to_stop(verb.axis, context),
                context.output);
  if (!attends) return ExitCode::done;
  return attend(verb, context);
}

constexpr const char* rotate_help = R"(
Turns until it is stopped: to the right for a positive velocity, to the left for a negative one. An
axis with soft limits does not turn without end. On an axis with a unit, VELOCITY needs one; --internal
takes it as the module counts. max_velocity (parameter 4) holds for positions: modules with a TMC429 open
it for ROR and ROL, and others have another register, so a faster VELOCITY is taken, with a warning. What
is above max_velocity in the configuration is refused.

It shows the axis until Ctrl-C, SIGTERM or SIGHUP, and stops it then. If this program is killed, tmcld
stops the axis; with --direct nothing does. With --unattended it comes back at once, and the axis turns
on until it is stopped.

  exit 0   stopped; with --unattended, or a velocity of zero: it was told so
       4   the stop was not confirmed: it may still turn
       5   it does not turn any more, although it was not stopped from here

  tmclctl rotate x -5mm/s
  tmclctl rotate x -500 --internal
  tmclctl rotate x 2rps
  tmclctl rotate x 61035pps --unattended
)";

}  // namespace

void add_rotate(Grammar& grammar) {
  auto rotate =
      grammar.verb<verb::Rotate>("rotate", access::acts, "Turn without end", rotate_help, run);
  rotate.axis(rotate->axis);
  rotate.word("VELOCITY", "With a unit; negative: to the left", text(rotate->velocity));
  rotate.flag("--unattended", "Come back at once, and let it turn unwatched", rotate->unattended);
  rotate.internal(rotate->internal);
}

}  // namespace tmclctl

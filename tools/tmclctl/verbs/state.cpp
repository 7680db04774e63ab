// state, watch.
#include <fmt/format.h>

#include "print.hpp"
#include "scale_factors.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

bool same(const AxisReading& a, const AxisReading& b) {
  return a.position == b.position && a.velocity == b.velocity && a.target == b.target &&
         a.moving == b.moving && a.position_reached == b.position_reached &&
         a.condition == b.condition;
}

std::string motion_text(const AxisReading& reading) {
  if (reading.moving) return "moving";
  if (reading.position_reached) return "at target";
  const auto& cause = reading.condition.stop_cause;
  return cause ? "stopped: " + *cause : "standing";
}

void print_change(const verb::Watch& verb, const AxisReading& reading, double at_s,
                  Output& output) {
  if (output.json) {
    auto document = to_json(verb.axis, reading);
    document["time_s"] = at_s;
    print_json(document, output);
    return;
  }
  output.out << fmt::format("{:9.3f} s  {}  position {}  velocity {}  target {}  {}", at_s,
                            verb.axis, position_text(reading, verb.internal),
                            velocity_text(reading, verb.internal),
                            target_text(reading, verb.internal), motion_text(reading))
             << std::endl;
}

void print_condition(const std::string& axis, const AxisCondition& condition, std::ostream& out) {
  if (condition.stop_cause) out << "stopped   " << *condition.stop_cause << '\n';
  if (condition.referenced) out << "reference found\n";
  if (condition.lease) out << "lease     " << *condition.lease << ": 'tmclctl lease list'\n";
  if (condition.unattended) out << "watched   by nobody: it turns until it is stopped\n";
  if (condition.latched) {
    out << "latched   its module has started again, or is another one: 'tmclctl home " << axis
        << "' or 'tmclctl recover " << axis << "'\n";
  }
}

}  // namespace

VerbResult run(const verb::State& verb, Context& context) {
  const auto reading = context.target.state(verb.axis);
  if (!reading) return tl::unexpected(reading.error());
  const auto factors = scale_factors_of(verb.axis, reading->user.has_value(), context.target);
  if (context.output.json) {
    auto document = to_json(verb.axis, *reading);
    add(factors, document);
    print_json(document, context.output);
    return ExitCode::done;
  }
  const auto with = [&](std::string text, bool has_unit) {
    return has_unit && !verb.internal ? text + " = " : "";
  };
  const auto& user = reading->user;
  const auto pps =
      reading->velocity_pps ? fmt::format(" ({:.1f} microsteps/s)", *reading->velocity_pps) : "";
  context.output.out << fmt::format(
      "axis      {}\nposition  {}{} microsteps\ntarget    {}{} microsteps{}\nvelocity  "
      "{}{}{}\nmoving    "
      "{}\n",
      verb.axis, with(position_text(*reading, false), user.has_value()), reading->position.value,
      with(target_text(*reading, false), user.has_value()), reading->target.value,
      reading->position_reached ? ", reached" : "",
      with(velocity_text(*reading, false), user && user->velocity), reading->velocity.value, pps,
      reading->moving ? "yes" : "no");
  if (factors.microsteps_per_unit && !verb.internal)
    context.output.out << fmt::format("unit      {}: {} microsteps", reading->user->unit,
                                      factor_text(factors.microsteps_per_unit))
                       << (factors.encoder_counts_per_unit
                               ? ", " + factor_text(factors.encoder_counts_per_unit) +
                                     " counts of its encoder"
                               : "")
                       << '\n';
  print_condition(verb.axis, reading->condition, context.output.out);
  return ExitCode::done;
}

VerbResult run(const verb::Watch& verb, Context& context) {
  const auto begin = context.host.now();
  const auto seconds_since_begin = [&](tmcl::TimePoint at) {
    return std::chrono::duration<double>(at - begin).count();
  };
  std::optional<AxisReading> last;
  const auto watched =
      context.target.watch(verb.axis, verb.interval, [&](const AxisReading* reading) {
        if (reading != nullptr && !(last && same(*last, *reading))) {
          print_change(verb, *reading, seconds_since_begin(context.host.now()), context.output);
          last = *reading;
        }
        // Ending it is what Ctrl-C is for here, so that is no failure.
        return context.host.signal() == 0 &&
               !(verb.for_s && seconds_since_begin(context.host.now()) >= *verb.for_s);
      });
  if (!watched && context.host.signal() == 0) return tl::unexpected(watched.error());
  return ExitCode::done;
}

}  // namespace tmclctl

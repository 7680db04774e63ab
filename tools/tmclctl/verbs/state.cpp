// state
#include <fmt/format.h>

#include "print.hpp"
#include "scale_factors.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

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

}  // namespace tmclctl

// state
#include <algorithm>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "axis/scale_factors.hpp"
#include "fleet/fleet_verbs.hpp"
#include "output/print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

void print_condition(const std::string& axis, const AxisReading& reading, std::ostream& out) {
  if (!reading.faults.empty())
    out << "WRONG     " << joined(reading.faults) << ": 'tmclctl errors " << axis << "'\n";
  if (reading.stop_cause) out << "stopped   " << *reading.stop_cause << '\n';
  if (reading.referenced) out << "reference found\n";
  if (reading.lease) out << "lease     " << *reading.lease << ": 'tmclctl lease list'\n";
  if (reading.owner && !reading.lease)
    out << "turns for " << *reading.owner << ": it is stopped when that ends\n";
  if (reading.unattended) out << "watched   by no client: it turns until it is stopped\n";
  if (reading.latched) {
    out << "latched   its module has started again, or is another one: 'tmclctl home " << axis
        << "' or 'tmclctl recover " << axis << "'\n";
  }
}

// ---- all axes

Result<ExitCode> run_on_all(const verb::State& verb, Context& context) {
  const auto axes = axes_of(context);
  if (!axes) return tl::unexpected(axes.error());
  auto exit = ExitCode::done;
  boost::json::array documents;
  Table table({"AXIS", "POSITION", "TARGET", "VELOCITY", "STATE"});
  for (const auto& axis : *axes) {
    const auto reading = state_of(axis.name, context);
    if (!reading) {
      exit = std::max(exit, exit_code_of(reading.error()));
      documents.push_back(
          boost::json::object{{"axis", axis.name}, {"error", error_document(reading.error())}});
      table.add({axis.name, "-", "-", "-", reading.error().message}, true);
      continue;
    }
    documents.push_back(tmcl::api::to_json<tmcl::api::axis::State>(*reading));
    table.add(
        {axis.name, position_text(*reading, verb.internal), target_text(*reading, verb.internal),
         velocity_text(*reading, verb.internal), remark_on(*reading)},
        !reading->faults.empty() || reading->latched);
  }
  if (context.output.json) {
    print_json({{"axes", std::move(documents)}}, context.output);
  } else {
    table.print(context.output);
  }
  return exit;
}

Result<ExitCode> run(const verb::State& verb, Context& context) {
  if (verb.axis.empty()) return run_on_all(verb, context);
  const auto reading = state_of(verb.axis, context);
  if (!reading) return tl::unexpected(reading.error());
  const auto factors = scale_factors_of(verb.axis, reading->position.has_value(), context);
  if (context.output.json) {
    auto document = tmcl::api::to_json<tmcl::api::axis::State>(*reading);
    add(factors, document);
    print_json(document, context.output);
    return ExitCode::done;
  }
  const auto with = [&](std::string text, bool has_unit) {
    return has_unit && !verb.internal ? text + " = " : "";
  };
  const auto pps =
      reading->velocity_pps ? fmt::format(" ({:.1f} microsteps/s)", *reading->velocity_pps) : "";
  context.output.out << fmt::format(
      "axis      {}\nposition  {}{} microsteps\ntarget    {}{} microsteps{}\nvelocity  "
      "{}{}{}\nmoving    "
      "{}\n",
      verb.axis, with(position_text(*reading, false), reading->position.has_value()),
      reading->position_microsteps, with(target_text(*reading, false), reading->target.has_value()),
      reading->target_microsteps, reading->position_reached ? ", reached" : "",
      with(velocity_text(*reading, false), reading->velocity.has_value()),
      reading->velocity_internal, pps, reading->moving ? "yes" : "no");
  if (factors.microsteps_per_unit && !verb.internal)
    context.output.out << fmt::format("unit      {}: {} microsteps", *reading->unit,
                                      factor_text(factors.microsteps_per_unit))
                       << (factors.encoder_counts_per_unit
                               ? ", " + factor_text(factors.encoder_counts_per_unit) +
                                     " counts of its encoder"
                               : "")
                       << '\n';
  print_condition(verb.axis, *reading, context.output.out);
  return ExitCode::done;
}

constexpr const char* state_help = R"(
Of an axis with a unit it also says how many microsteps, and counts of its encoder, a unit is.

  tmclctl state                                  all axes, a line each
  tmclctl state x
  tmclctl --json state x                         with every value in both units
)";

}  // namespace

void add_state(Grammar& grammar) {
  auto state = grammar.verb<verb::State>("state", access::reads,
                                         "Show where an axis is and what it does", state_help, run);
  state.optional_word("AXIS", axis_meaning, text(state->axis));
  state.internal(state->internal);
  state.in_fleet(run_in_fleet);
}

}  // namespace tmclctl

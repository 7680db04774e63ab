// errors.
#include <fmt/format.h>

#include "output/print.hpp"
#include "tmcl/api/errors.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;

/// A dash where there is nothing.
std::string words(const std::vector<std::string>& names) {
  return names.empty() ? "-" : joined(names);
}

std::string measured(const std::optional<double>& value, std::string_view unit) {
  return value ? fmt::format("{:.1f} {}", *value, unit) : "-";
}

void add_row(Table& table, const api::axis::Errors& errors) {
  table.add(
      {errors.axis, words(errors.flags), errors.stop_cause.value_or("-"), words(errors.switches),
       measured(errors.supply_volts, "V"), measured(errors.temperature_celsius, "deg C")},
      !errors.flags.empty());
}

Result<ExitCode> run(const verb::Errors& verb, Context& context) {
  std::vector<std::string> names{verb.axis};
  if (verb.axis.empty()) {
    const auto axes = axes_of(context);
    if (!axes) return tl::unexpected(axes.error());
    names.clear();
    for (const auto& axis : *axes) names.push_back(axis.name);
  }
  json::array all;
  Table table({"AXIS", "WRONG", "STOPPED BY", "CLOSED SWITCHES", "SUPPLY", "TEMPERATURE"});
  auto exit = ExitCode::done;
  for (const auto& name : names) {
    const auto errors = context.call(api::axis::GetErrors{name});
    if (!errors && !verb.axis.empty()) return tl::unexpected(errors.error());
    if (errors) {
      add_row(table, *errors);
      if (!errors->flags.empty()) exit = std::max(exit, ExitCode::refused);
      all.push_back(api::to_json(*errors));
      continue;
    }
    // The others are asked all the same.
    exit = std::max(exit, exit_code_of(errors.error()));
    all.push_back(json::object{{"axis", name}, {"error", error_document(errors.error())}});
    if (!context.output.json)
      context.output.err << "tmclctl: " << name << ": "
                         << error_text(errors.error(), context.output.gateway) << '\n';
  }
  if (context.output.json) {
    print_json({{"axes", std::move(all)}}, context.output);
  } else {
    table.print(context.output);
  }
  return exit;
}

constexpr const char* errors_help = R"(
Asks the modules of all axes, or of one, what they know about themselves: stops by stallGuard or the
encoder, what the driver reports (too hot, shorts, coils that are not connected), closed switches, and
supply and temperature where the module measures them. Reading clears the flags 'stall' and 'deviation';
the column STOPPED BY keeps them until the axis moves again. Coils can be told to be open only while
the motor turns slowly. A supply below 7 V is 'undervoltage'. If anything is wrong, the exit code is 1.

  tmclctl errors
  tmclctl --json errors x
)";

}  // namespace

void add_errors(Grammar& grammar) {
  auto errors = grammar.verb<verb::Errors>("errors", access::reads,
                                           "Say what modules report as wrong", errors_help, run);
  errors.optional_word("AXIS", axis_meaning, text(errors->axis));
}

}  // namespace tmclctl

// errors.
#include <fmt/format.h>

#include "json_read.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

/// A dash where there is nothing.
std::string words(const json::value& names) {
  std::string all;
  for (const auto& name : names.as_array())
    all += (all.empty() ? "" : ", ") + std::string(name.as_string());
  return all.empty() ? "-" : all;
}

std::string measured(const json::value& value, std::string_view unit) {
  return value.is_null() ? "-" : fmt::format("{:.1f} {}", value.to_number<double>(), unit);
}

void add_row(Table& table, const json::object& errors) {
  const auto& cause = errors.at("stop_cause");
  table.add({std::string(errors.at("axis").as_string()), words(errors.at("flags")),
             cause.is_null() ? "-" : std::string(cause.as_string()), words(errors.at("switches")),
             measured(errors.at("supply_volts"), "V"),
             measured(errors.at("temperature_celsius"), "deg C")});
}

}  // namespace

VerbResult run(const verb::Errors& verb, Context& context) {
  std::vector<std::string> names{verb.axis};
  if (verb.axis.empty()) {
    const auto axes = context.target.axes();
    if (!axes) return tl::unexpected(axes.error());
    names.clear();
    for (const auto& axis : *axes) names.push_back(axis.name);
  }
  json::array all;
  Table table({"AXIS", "WRONG", "STOPPED BY", "CLOSED SWITCHES", "SUPPLY", "TEMPERATURE"});
  auto exit = ExitCode::done;
  for (const auto& name : names) {
    const auto errors = context.target.perform("axis.get_errors", {{"axis", name}}, {});
    if (!errors && !verb.axis.empty()) return tl::unexpected(errors.error());
    if (errors) {
      add_row(table, *errors);
      if (!errors->at("flags").as_array().empty()) exit = std::max(exit, ExitCode::refused);
      all.push_back(*errors);
      continue;
    }
    // The others are asked all the same.
    exit = std::max(exit, exit_code_of(errors.error()));
    all.push_back(json::object{{"axis", name}, {"error", error_document(errors.error())}});
    if (!context.output.json)
      context.output.err << "tmclctl: " << name << ": " << error_text(errors.error()) << '\n';
  }
  if (context.output.json) {
    print_json({{"axes", std::move(all)}}, context.output);
  } else {
    table.print(context.output.out);
  }
  return exit;
}

}  // namespace tmclctl

// axes, params, and the words for the shell's completion.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "axis/scale_factors.hpp"
#include "fleet/fleet_verbs.hpp"
#include "output/print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace parameter = tmcl::api::parameter;
using parameter::Parameter;
using parameter::Value;

template <class Row>
json::array to_json_array(const std::vector<Row>& rows) {
  json::array array;
  for (const auto& row : rows) array.push_back(to_json(row));
  return array;
}

json::object to_json(const Parameter& row, const std::optional<Value>& value) {
  json::object object{{"number", row.number},
                      {"name", row.name},
                      {"aliases", json::array(row.aliases.begin(), row.aliases.end())},
                      {"access", row.access},
                      {"stored", row.stored},
                      {"minimum", row.minimum},
                      {"maximum", row.maximum},
                      {"default", row.initial},
                      {"unit", row.unit},
                      {"meaning", row.meaning}};
  if (value) object["value"] = value->value;
  if (const auto shown = value ? in_unit(value->value_in_unit, value->unit) : std::nullopt) {
    object["value_in_unit"] = shown->value;
    object["axis_unit"] = shown->unit;
  }
  return object;
}

std::vector<std::string> headings(bool values, bool in_unit) {
  std::vector<std::string> names{"NUMBER", "NAME"};
  if (values) names.push_back("VALUE");
  if (in_unit) names.push_back("IN UNIT");
  names.insert(names.end(), {"ACCESS", "RANGE", "UNIT", "MEANING"});
  return names;
}

std::vector<std::string> cells_of(const Parameter& row, const std::optional<Value>& value,
                                  bool internal) {
  std::vector<std::string> cells{std::to_string(row.number), row.name};
  if (value) cells.push_back(std::to_string(value->value));
  if (value && !internal) {
    const auto known = in_unit(value->value_in_unit, value->unit);
    cells.push_back(known ? shown(known, value->value) : "");
  }
  const bool writable = row.access == "read_write";
  cells.emplace_back(access_text(writable, row.stored));
  cells.push_back(writable ? fmt::format("{}..{}", row.minimum, row.maximum) : "read only");
  cells.push_back(row.unit);
  cells.push_back(row.meaning);
  return cells;
}

json::array to_json(const std::vector<AxisRow>& rows, const std::vector<ScaleFactors>& factors) {
  auto axes = to_json_array(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) add(factors[i], axes[i].as_object());
  return axes;
}

/// What units are is told where an axis has one.
void print(const std::vector<AxisRow>& rows, const std::vector<ScaleFactors>& factors,
           std::ostream& out) {
  const bool has_unit =
      std::ranges::any_of(rows, [](const AxisRow& row) { return row.unit.has_value(); });
  std::vector<std::string> headings{"AXIS", "BUS", "ADDRESS", "MOTOR", "MODEL", "STATE", "UNIT"};
  if (has_unit) headings.insert(headings.end(), {"MICROSTEPS/UNIT", "COUNTS/UNIT"});
  const bool has_faults =
      std::ranges::any_of(rows, [](const AxisRow& row) { return !row.faults.empty(); });
  if (has_faults) headings.emplace_back("FAULTS");
  Table table(std::move(headings));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    std::vector<std::string> cells{row.name,
                                   row.bus,
                                   std::to_string(row.address),
                                   std::to_string(row.motor),
                                   row.model.value_or("unknown"),
                                   row.state,
                                   row.unit.value_or("-")};
    if (has_unit) {
      cells.push_back(factor_text(factors[i].microsteps_per_unit));
      cells.push_back(factor_text(factors[i].encoder_counts_per_unit));
    }
    if (has_faults) cells.push_back(row.faults.empty() ? "-" : joined(row.faults));
    table.add(std::move(cells));
  }
  table.print(out);
}

}  // namespace

Result<ExitCode> run(const verb::Axes&, Context& context) {
  const auto rows = axes_of(context);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<ScaleFactors> factors;
  for (const auto& row : *rows)
    factors.push_back(
        scale_factors_of(row.name, row.unit.has_value() && row.state == "ready", context));
  if (context.output.json) {
    print_json({{"axes", to_json(*rows, factors)}}, context.output);
    return ExitCode::done;
  }
  print(*rows, factors, context.output.out);
  std::set<std::string> told;
  for (const auto& row : *rows) {
    if (!row.why.empty() && told.insert(row.bus).second)
      context.output.err << fmt::format("bus {} is not open: {}\n", row.bus, row.why);
  }
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Params& verb, Context& context) {
  const auto listed = context.call(parameter::List{verb.axis});
  if (!listed) return tl::unexpected(listed.error());
  const auto& rows = listed->parameters;
  std::vector<std::optional<Value>> values(rows.size());
  for (std::size_t i = 0; verb.values && i < rows.size(); ++i) {
    const auto got = context.call(parameter::Get{{verb.axis, rows[i].number}});
    if (!got) return tl::unexpected(got.error());
    values[i] = *got;
  }
  const bool has_unit = std::ranges::any_of(
      values, [](const auto& value) { return value && value->value_in_unit.has_value(); });
  const bool internal = verb.internal || !has_unit;
  json::array array;
  Table table(headings(verb.values, verb.values && !internal));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    array.push_back(to_json(rows[i], values[i]));
    table.add(cells_of(rows[i], values[i], internal));
  }
  if (context.output.json) {
    print_json({{"axis", verb.axis}, {"parameters", std::move(array)}}, context.output);
  } else {
    table.print(context.output.out);
  }
  return ExitCode::done;
}

namespace {

Result<std::vector<std::string>> names_of(const std::string& kind, Context& context) {
  std::vector<std::string> names;
  if (kind == "axes") {
    const auto rows = axes_of(context);
    if (!rows) return tl::unexpected(rows.error());
    for (const auto& row : *rows) names.push_back(row.name);
    return names;
  }
  const auto buses = context.call(tmcl::api::bus::List{});
  if (!buses) return tl::unexpected(buses.error());
  for (const auto& bus : buses->buses) names.push_back(bus.name);
  if (kind == "buses") return names;
  const bool needs_bus = names.size() > 1;
  const auto modules = modules_of(context);
  if (!modules) return tl::unexpected(modules.error());
  names.clear();
  for (const auto& module : *modules)
    names.push_back(needs_bus ? fmt::format("{}:{}", module.bus, module.address)
                              : std::to_string(module.address));
  return names;
}

}  // namespace

Result<ExitCode> complete_by_gateway(const Completion& completion, Context& context) {
  const auto names = names_of(completion.of_gateway, context);
  if (!names) return tl::unexpected(names.error());
  for (const auto& name : *names)
    context.output.out << completion.prefix << name << completion.suffix << '\n';
  return ExitCode::done;
}

namespace {

constexpr const char* axes_help = R"(
The axes of tmcld's configuration; with --direct those of all modules that a scan finds. Where the state
is unknown because a bus is not open, it says why. Of an axis with a unit it says how many microsteps,
and counts of its encoder, a unit is.

  tmclctl axes
  tmclctl --direct can:can0 axes
)";

constexpr const char* params_help = R"(
An axis has the parameters of its module's model; without a module, --model lists those of any.
ACCESS is R (can be read), RW (and set), or RWE (and stored in the EEPROM, with 'tmclctl store').

  tmclctl params x --values
  tmclctl params --model TMCM-1276
  tmclctl params --model TMCM-1276 --globals
)";

}  // namespace

void add_lists(Grammar& grammar) {
  auto axes = grammar.verb<verb::Axes>("axes", access::reads,
                                       "List the axes and how they are called", axes_help, run);
  axes.in_fleet(run_in_fleet);
  auto params = grammar.verb<verb::Params>(
      "params", access::reads, "List the parameters of an axis or a model", params_help, run);
  params.optional_word("AXIS", axis_meaning, text(params->axis));
  params.flag("--values", "Read them all, too", params->values);
  params.internal(params->internal);
  params.option("--model", "MODEL", "Of this model, without any module", text(params->model));
  params.flag("--globals", "With --model: the global parameters", params->globals);
  params.alone([](const verb::Params& said) { return !said.model.empty(); }, run_on_model);
  params.object([](const verb::Params& said, bool) {
    if (said.axis.empty() == said.model.empty()) return "name an axis, or say --model MODEL";
    if (said.model.empty()) return said.globals ? "--globals needs --model" : "";
    return said.values ? "--values needs an axis to read from" : "";
  });
}

}  // namespace tmclctl

// scan, modules, axes, params, and the words for the shell's completion.
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "axis/scale_factors.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
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

std::string model_text(const std::string& model, unsigned number) {
  if (!model.empty()) return model;
  return number != 0 ? fmt::format("unknown ({})", number) : "unknown";
}

std::string remark_on(const ModuleRow& row) {
  if (row.address_is_reply_id)
    return "DANGER: its address is the identifier of all replies, so it takes them for commands "
           "and moves. Give it another address (global parameter 71)";
  if (row.duplicate_suspected)
    return "DUPLICATE: several modules answer at this address, or another program asks";
  if (row.in_bootloader)
    return "NO FIRMWARE runs, only its bootloader: see tmclctl firmware upload";
  if (row.watched_by == "none") return "UNWATCHED: it is not noticed when it starts again";
  return "";
}

void print_modules(const std::vector<ModuleRow>& rows, bool with_state, std::ostream& out) {
  std::vector<std::string> headings{"BUS", "ADDRESS", "MODEL", "FIRMWARE", "AXES"};
  if (with_state) headings.push_back("STATE");
  headings.push_back("");
  Table table(headings);
  for (const auto& row : rows) {
    std::vector<std::string> cells{row.bus, std::to_string(row.address),
                                   model_text(row.model, row.model_number), row.firmware,
                                   row.axes != 0 ? std::to_string(row.axes) : "?"};
    if (with_state) cells.push_back(row.state);
    cells.push_back(remark_on(row));
    table.add(std::move(cells));
  }
  table.print(out);
}

Result<ExitCode> show_modules(const std::vector<ModuleRow>& rows, bool with_state, Output& output) {
  if (output.json) {
    print_json({{"modules", to_json_array(rows)}}, output);
  } else {
    print_modules(rows, with_state, output.out);
  }
  return ExitCode::done;
}

Result<ExitCode> show_partial_scan(const ScanResult& result, Output& output) {
  auto exit = ExitCode::done;
  json::array failed;
  for (const auto& [bus, failure] : result.failed) {
    exit = std::max(exit, exit_code_of(failure));
    failed.push_back(json::object{{"bus", bus}, {"error", error_document(failure)}});
    if (!output.json) {
      output.err << "tmclctl: " << bus << " was not scanned: " << error_text(failure) << '\n';
    }
  }
  if (output.json) {
    print_json({{"modules", to_json_array(result.modules)}, {"failed", std::move(failed)}}, output);
  } else {
    print_modules(result.modules, false, output.out);
  }
  return exit;
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
                                   model_text(row.model.value_or(""), 0),
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

namespace {

/// Bytes that have come on all buses and belong to no reply; 0 where that is not known.
std::uint64_t garbage_bytes(Context& context) {
  const auto listed = context.call(tmcl::api::bus::List{});
  std::uint64_t bytes = 0;
  if (!listed) return bytes;
  for (const auto& bus : listed->buses) bytes += bus.counters.garbage_bytes;
  return bytes;
}

void print_silence(std::uint64_t garbage, Output& output) {
  if (garbage != 0) {
    output.err << fmt::format(
        "No module answered, but {} bytes came that are no replies: the modules have another baud "
        "rate (new ones speak 9600), the adapter echoes, or there is noise. ",
        garbage);
  } else {
    output.err << "No module answered. Check the supply, the cabling, the baud rate (new modules "
                  "speak 9600) and ";
  }
  output.err << (garbage != 0 ? "Check also " : "") << "whether another program holds the port.\n";
}

}  // namespace

Result<ExitCode> run(const verb::Scan& verb, Context& context) {
  const auto garbage_before = garbage_bytes(context);
  ProgressLine line(context.output);
  const auto show = [&](const std::string& bus, std::size_t asked, std::size_t of) {
    line.show(fmt::format("scanning {}: {} of {} addresses", bus, asked, of));
  };
  const auto rows = scan(verb.range, show, context);
  line.clear();
  if (!rows) return tl::unexpected(rows.error());
  if (!rows->failed.empty()) return show_partial_scan(*rows, context.output);
  if (rows->modules.empty() && !context.output.json) {
    print_silence(garbage_bytes(context) - garbage_before, context.output);
    return ExitCode::not_sent;
  }
  return show_modules(rows->modules, false, context.output).map([&](ExitCode done) {
    return rows->modules.empty() ? ExitCode::not_sent : done;
  });
}

Result<ExitCode> run(const verb::Modules&, Context& context) {
  const auto rows = modules_of(context);
  if (!rows) return tl::unexpected(rows.error());
  return show_modules(*rows, true, context.output);
}

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

Reading read_range(const std::string& text, ScanRange& range) {
  const auto dash = text.find('-');
  const auto first = text.substr(0, dash);
  const auto last = dash == std::string::npos ? first : text.substr(dash + 1);
  return number(range.first, 0, greatest_address)(first).and_then(
      [&] { return number(range.last, range.first, greatest_address)(last); });
}

constexpr const char* scan_help = R"(
Asks every address who is there: through tmcld on all its buses, with --direct on that one.
One row for each module that answers; exit code 3 if none does. Takes some seconds on a slow serial
line. NO FIRMWARE marks a module whose bootloader answers, as after an upload that was cut short.

  tmclctl scan
  tmclctl --direct can:can0 scan --addresses 1-20
  tmclctl --direct tcp:10.0.0.7:4001 --reply-timeout 1000 scan     far away, so answers take long
)";

constexpr const char* modules_help = R"(
Those of the axes in tmcld's configuration, and how they are: ready, silent (they do not answer), or
unknown (their bus is not open, or they were not asked yet). With --direct it is a scan.

  tmclctl modules
  tmclctl --json modules
)";

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
  auto scan = grammar.verb<verb::Scan>("scan", access::reads, "Look for modules on all addresses",
                                       scan_help, run);
  auto& range = scan->range;
  scan.option("--addresses", "FIRST-LAST", "Only these addresses (default 1-255)",
              [&range](const std::string& text) { return read_range(text, range); });
  grammar.verb<verb::Modules>("modules", access::reads, "List the modules that tmcld serves",
                              modules_help, run);
  grammar.verb<verb::Axes>("axes", access::reads, "List the axes and how they are called",
                           axes_help, run);
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

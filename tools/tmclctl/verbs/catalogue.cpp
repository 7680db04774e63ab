// models, and params of a model: what the tables know, without any module.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "axis/axis_names.hpp"
#include "output/print.hpp"
#include "tmcl/model_document.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

std::vector<std::string_view> interfaces_of(const tmcl::Model& model) {
  std::vector<std::string_view> names;
  if ((model.interfaces & tmcl::usb) != 0) names.emplace_back("USB");
  if ((model.interfaces & tmcl::rs232) != 0) names.emplace_back("RS232");
  if ((model.interfaces & tmcl::rs485) != 0) names.emplace_back("RS485");
  if ((model.interfaces & tmcl::can) != 0) names.emplace_back("CAN");
  return names;
}

json::object to_json(const tmcl::Model& model) {
  json::array interfaces;
  for (const auto name : interfaces_of(model)) interfaces.push_back(json::value(name));
  json::array analog_inputs;
  for (int port = 0; port < 16; ++port) {
    if ((model.ports.analog_inputs >> port & 1) != 0) analog_inputs.push_back(port);
  }
  return {{"number", model.number},
          {"name", model.name},
          {"axes", model.axes},
          {"ramps", name_of(model.family)},
          {"chips", model.chips},
          {"interfaces", std::move(interfaces)},
          {"digital_inputs", model.ports.digital_inputs},
          {"analog_inputs", std::move(analog_inputs)},
          {"outputs", model.ports.outputs},
          {"document", tmcl::document_of(model)}};
}

json::object to_json(const tmcl::ParameterInfo& row) {
  json::array aliases;
  for (const auto alias : row.aliases) {
    if (!alias.empty()) aliases.push_back(json::value(alias));
  }
  return {{"number", row.number},
          {"name", row.name},
          {"aliases", std::move(aliases)},
          {"access", row.access == tmcl::Access::read ? "read" : "read_write"},
          {"stored", row.stored},
          {"minimum", row.minimum},
          {"maximum", row.maximum},
          {"default", row.initial},
          {"unit", row.unit},
          {"register", row.chip_register},
          {"meaning", row.meaning}};
}

}  // namespace

Result<ExitCode> run(const verb::Models&, Output& output) {
  json::array array;
  Table table({"MODEL", "AXES", "RAMPS", "CHIPS", "INTERFACES"});
  for (const auto& model : tmcl::models()) {
    array.push_back(to_json(model));
    table.add({std::string(model.name), std::to_string(model.axes),
               std::string(name_of(model.family)), std::string(model.chips),
               fmt::format("{}", fmt::join(interfaces_of(model), " "))});
  }
  if (output.json) {
    print_json({{"models", std::move(array)}}, output);
  } else {
    table.print(output);
  }
  return ExitCode::done;
}

Result<ExitCode> run_on_model(const verb::Params& verb, Output& output) {
  const auto model = parse_model(verb.model);
  if (!model) return tl::unexpected(model.error());
  const auto rows =
      verb.globals ? tmcl::global_parameters(**model) : tmcl::axis_parameters(**model);
  json::array array;
  Table table({"NUMBER", "NAME", "ACCESS", "RANGE", "DEFAULT", "UNIT", "MEANING"});
  for (const auto& row : rows) {
    array.push_back(to_json(row));
    table.add({std::to_string(row.number), std::string(row.name),
               std::string(access_text(row.access == tmcl::Access::read_write, row.stored)),
               fmt::format("{}..{}", row.minimum, row.maximum), std::to_string(row.initial),
               std::string(row.unit), std::string(row.meaning)});
  }
  if (output.json) {
    print_json({{"model", (*model)->name}, {"parameters", std::move(array)}}, output);
  } else {
    table.print(output);
  }
  return ExitCode::done;
}

namespace {

constexpr const char* models_help = R"(
Needs no module. 'tmclctl params --model MODEL' lists what one of them can be told. With --json,
"document" is the manual that its ranges follow, or says that there is none.

  tmclctl models
  tmclctl params --model TMCM-1110
)";

}  // namespace

void add_models(Grammar& grammar) {
  grammar.verb<verb::Models>("models", access::offline("it shows what this program knows"),
                             "List the models that are known", models_help, run);
}

}  // namespace tmclctl

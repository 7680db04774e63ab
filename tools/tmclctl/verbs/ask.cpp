// Whatever is one method of tmcld.
#include "ask.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "axis/axis_names.hpp"
#include "connection/json_read.hpp"
#include "output/print.hpp"
#include "tmcl/api/settings.hpp"
#include "tmcl/json_text.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl {

bool only_reads(std::string_view method) {
  return method.ends_with(".get") || method.ends_with(".info") || method.ends_with(".status");
}

namespace {

namespace json = boost::json;

Result<json::object> params_of(const verb::Ask& verb, Context& context) {
  json::object params;
  const auto add = [&](const char* key, const std::optional<std::int32_t>& value) {
    if (value) params[key] = *value;
  };
  if (!verb.axis.empty()) params["axis"] = verb.axis;
  if (!verb.module.empty()) {
    const auto module = on_module(verb.module, context);
    if (!module) return tl::unexpected(module.error());
    params = tmcl::api::to_json(*module);
  }
  if (!verb.motors.empty()) params["motors"] = json::array(verb.motors.begin(), verb.motors.end());
  if (!verb.axes.empty()) params["axes"] = json::array(verb.axes.begin(), verb.axes.end());
  if (verb.interpolated) params["interpolated"] = true;
  if (!verb.parameter.empty()) params["parameter"] = verb.parameter;
  add("bank", verb.bank);
  add("number", verb.number);
  add("port", verb.port);
  add("value", verb.value);
  add("at", verb.at);
  add("first_address", verb.first_address);
  const Typed position{verb.position, verb.internal};
  if (const auto amount = position.amount()) params["position"] = tmcl::api::write_value(*amount);
  add("position_microsteps", position.counted());
  return params;
}

/// 65537 is 1.1: GET_INFO has major and minor version in a half each.
std::string version_text(std::int64_t version) {
  return fmt::format("{}.{}", version >> 16U & 0xFFFF, version & 0xFFFF);
}

std::string text_of(std::string_view key, const json::value& value) {
  if (key.ends_with("version") && value.is_int64()) return version_text(value.get_int64());
  if (value.is_null()) return "-";
  if (const auto* text = value.if_string()) return {text->data(), text->size()};
  return tmcl::json_text(value);
}

// "12.5mm", as it can be typed, too.
void print_position(const Quantity& position, std::ostream& out) {
  out << tmcl::plain_number(position.number, 12) << position.unit << '\n';
}

/// One bare value where there is one, for scripts; else a line for each.
void print(const json::object& result, bool internal, std::ostream& out) {
  const auto in_unit = number_at(result, "position");
  if (in_unit && !internal) return print_position({*in_unit, text_at(result, "unit")}, out);
  for (const auto* bare : {"value", "position_microsteps"}) {
    if (const auto* value = result.if_contains(bare)) {
      out << text_of(bare, *value) << '\n';
      return;
    }
  }
  for (const auto& [key, value] : result)
    out << fmt::format("{:<24}{}\n", std::string_view(key), text_of(key, value));
}

bool gives_something(std::string_view method) {
  return only_reads(method) || method.ends_with(".capture");
}

/// What was done, where that is not what one might expect; {0} is the module or the axes.
struct Told {
  std::string_view method;
  std::string_view text;
};
constexpr auto told = std::to_array<Told>({
    {"program.run", "module {0}: the program runs"},
    {"program.stop", "module {0}: the program has ended"},
    {"program.step", "module {0}: one command of the program was executed"},
    {"program.reset", "module {0}: the program has ended, and is back at its start"},
    {"program.set_breakpoint", "module {0}: the program will stand before command {1}"},
    {"program.clear_breakpoint", "module {0}: no breakpoint at command {1} any more"},
    {"program.clear_breakpoints", "module {0}: no breakpoints any more"},
    {"path.pause", "{0}: paused on the path"},
    {"path.resume", "{0}: going on along the path"},
    {"path.stop", "{0}: the path has ended, and all of its axes were stopped"},
});

std::string names_in(const json::array& axes) {
  std::string names;
  for (const auto& axis : axes)
    names += (names.empty() ? "" : ", ") + std::string(axis.as_string());
  return names;
}

/// What could not be stored is told, and the others are stored.
void tell_stored(const verb::Ask& verb, const json::object& result, Context& context) {
  for (const auto& one : array_at(result, "refused"))
    warn(fmt::format("{} is not stored: {}", text_at(one.as_object(), "parameter"),
                     text_at(one.as_object(), "why")),
         context.output);
  context.output.out << fmt::format("{}: {} settings are stored\n", verb.axis,
                                    number_at(result, "stored").value_or(0));
}

void tell(const verb::Ask& verb, const json::object& result, Context& context) {
  if (verb.all) return tell_stored(verb, result, context);
  const auto* line = std::ranges::find(told, verb.method, &Told::method);
  if (line == told.end()) return;
  const bool of_path = verb.method.starts_with("path.");
  const auto whom = of_path ? names_in(array_at(result, "axes")) : verb.module;
  if (whom.empty()) {
    context.output.out << "No axis is on a path that tmcld passes\n";
    return;
  }
  context.output.out << fmt::format(fmt::runtime(line->text), whom, verb.at.value_or(0)) << '\n';
  if (verb.method == "program.stop" || verb.method == "program.reset") {
    context.output.out << fmt::format(
        "Motors that turn go on. Stop them with: tmclctl{} stop AXIS\n", context.output.gateway);
  }
}

/// As the gateway finds it: "x_target" is "XTarget", too.
bool is_called(const tmcl::api::parameter::Parameter& row, const std::string& name) {
  if (std::to_string(row.number) == name) return true;
  tmcl::ParameterInfo names{};
  names.name = row.name;
  std::copy_n(row.aliases.begin(), std::min(row.aliases.size(), names.aliases.size()),
              names.aliases.begin());
  return find_parameter(std::span(&names, 1), name) != nullptr;
}

/// Modules refuse to store a parameter in the same words as one that they do not know.
Error explained(Error failure, const verb::Ask& verb, Context& context) {
  const bool of_eeprom = verb.method == "parameter.store" || verb.method == "parameter.restore";
  if (!of_eeprom || failure.outcome != tmcl::Outcome::refused) return failure;
  const auto listed = context.call(tmcl::api::parameter::List{verb.axis});
  if (!listed) return failure;
  const auto& rows = listed->parameters;
  const auto row =
      std::ranges::find_if(rows, [&](const auto& one) { return is_called(one, verb.parameter); });
  if (row == rows.end() || row->stored) return failure;
  failure.message =
      fmt::format("{} cannot be kept in the EEPROM of {}'s module", row->name, verb.axis);
  failure.hint = fmt::format("'tmclctl{} params {}' shows RWE at what can be kept",
                             context.output.gateway, verb.axis);
  return failure;
}

/// The same, saying what it is about.
json::object named(const verb::Ask& verb, json::object result) {
  const auto add = [&](const char* key, const std::string& name) {
    if (!name.empty() && !result.contains(key)) result[key] = name;
  };
  add("axis", verb.axis);
  add("module", verb.module);
  return result;
}

Result<ExitCode> run(const verb::Ask& verb, Context& context) {
  auto params = params_of(verb, context);
  if (!params) return tl::unexpected(params.error());
  const auto method = verb.all ? std::string(tmcl::api::settings::Store::method.name) : verb.method;
  const auto result = context.gateway.caller.call(method, std::move(*params));
  if (!result) return tl::unexpected(explained(result.error(), verb, context));
  if (context.output.json) {
    print_json(named(verb, *result), context.output);
  } else if (gives_something(verb.method)) {
    print(*result, verb.internal, context.output.out);
  } else {
    tell(verb, *result, context);
  }
  return ExitCode::done;
}

}  // namespace

AskForm ask(Grammar& grammar, const Form& group, const std::string& name, const Access& access,
            const char* method, const std::string& description, const char* footer) {
  auto form = grammar.verb<verb::Ask>(group, name, access, description, footer, run);
  form->method = method;
  return form;
}

AskForm ask(Grammar& grammar, const std::string& name, const Access& access, const char* method,
            const std::string& description, const char* footer) {
  auto form = grammar.verb<verb::Ask>(name, access, description, footer, run);
  form->method = method;
  return form;
}

void add_parameter(AskForm& form) {
  form.word("PARAM", "Number or standard name", text(form->parameter));
}

}  // namespace tmclctl

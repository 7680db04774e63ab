// get, set.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "output/print.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace parameter = tmcl::api::parameter;

/// In the unit of the axis, or in turns if it has none.
Result<Quantity> in_units(const parameter::Value& got, const std::string& axis, Context& context) {
  if (const auto shown = in_unit(got.value_in_unit, got.unit))
    return Quantity{shown->value, shown->unit};
  const auto units = units_of(axis, context);
  if (!units) return tl::unexpected(units.error());
  const auto* row = find_parameter(units->parameters(), got.number);
  if (row != nullptr) return attempt(from_parameter(got.value, *units, *row));
  return tl::unexpected(usage_error(
      "unknown_unit",
      fmt::format("what parameter {} of axis {} counts in is not known", name_of(got), axis)));
}

Result<ExitCode> run(const verb::Get& verb, Context& context) {
  const auto got = context.call(parameter::Get{{verb.axis, name_or_number(verb.parameter)}});
  if (!got) return tl::unexpected(got.error());
  auto document = tmclctl::to_json(verb.axis, *got);
  auto line = fmt::format("{}\n", got->value);
  if (verb.in_units) {
    const auto shown = in_units(*got, verb.axis, context);
    if (!shown) return tl::unexpected(shown.error());
    document["value_in_unit"] = shown->number;
    document["unit"] = shown->unit;
    line = tmcl::plain_number(shown->number, 12) + shown->unit + '\n';
  }
  if (context.output.json) {
    print_json(document, context.output);
  } else {
    context.output.out << line;
  }
  return ExitCode::done;
}

Result<ExitCode> run(const verb::Set& verb, Context& context) {
  const Typed value{verb.value, true};
  const auto set = context.call(
      parameter::Set{{verb.axis, name_or_number(verb.parameter)}, value.counted(), value.amount()});
  if (!set) return tl::unexpected(set.error());
  warn(set->warnings, context.output);
  if (!context.output.json) return ExitCode::done;
  auto document = tmclctl::to_json(verb.axis, *set);
  document["warnings"] = json::array(set->warnings.begin(), set->warnings.end());
  print_json(document, context.output);
  return ExitCode::done;
}

constexpr const char* get_help = R"(
Prints one bare number, so that a script needs no parsing. With --in-units its unit stands behind it,
as 'set' takes it.

  position=$(tmclctl get x actual_position)
  tmclctl get x max_velocity --in-units          5.9604644775mm/s
  tmclctl --direct tcp:127.0.0.1:4001 get 1/0 4
)";

constexpr const char* set_help = R"(
A bare number is what the module counts, on every axis. A position, velocity or acceleration may have
a unit, as 'get --in-units' prints it, and becomes the nearest value there is. The module forgets the value when it loses power, unless 'tmclctl store' keeps it.
Writing target_position, actual_position, target_velocity or ramp_mode can move the motor. What the
settings of a ramp then make of moves that are hardly wanted, such as a bow with which the motor swings,
is told as a warning.

  tmclctl set x max_velocity 1500
  tmclctl set x max_velocity 20000pps
  tmclctl set x max_acceleration 50mm/s^2
)";

}  // namespace

void add_parameters(Grammar& grammar) {
  auto get = grammar.verb<verb::Get>("get", access::reads,
                                     "Read a parameter: prints one bare number", get_help, run);
  get.axis(get->axis);
  get.word("PARAM", "Number or standard name", text(get->parameter));
  get.flag("--in-units", "Print it with the unit of the axis, or in turns if it has none",
           get->in_units);
  auto set = grammar.verb<verb::Set>("set", access::acts, "Set a parameter", set_help, run);
  set.axis(set->axis);
  set.word("PARAM", "Number or standard name", text(set->parameter));
  set.word(
      "VALUE",
      "The new value, as the module counts; positions, velocities and accelerations may have units",
      text(set->value));
}

}  // namespace tmclctl

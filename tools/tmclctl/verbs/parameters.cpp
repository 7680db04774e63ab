// get, set.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "print.hpp"
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

}  // namespace

Result<ExitCode> run(const verb::Get& verb, Context& context) {
  const auto got = context.call(parameter::Get{{verb.axis, name_or_number(verb.parameter)}});
  if (!got) return tl::unexpected(got.error());
  auto document = to_json(verb.axis, *got);
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
  auto document = to_json(verb.axis, *set);
  document["warnings"] = json::array(set->warnings.begin(), set->warnings.end());
  print_json(document, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl

#include "api/quantity.hpp"

#include <cmath>
#include <utility>

#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

namespace ap = tmcl::axis_parameter;
using boost::asio::awaitable;
using tmcl::AxisUnits;
using tmcl::Dimension;
using tmcl::Quantity;
using tmcl::quoted;

Error has_no_unit_of_its_own(const GatewayAxis& axis, std::string_view param) {
  return param_error("bad_argument", param,
                     "axis " + quoted(axis.name()) + " has no unit of its own",
                     "the configuration gives it one by 'unit' and 'units_per_revolution'; a text "
                     "can be in others, such as '1.5rev'");
}

/// What one of them says.
struct ParsedAmount {
  std::string_view param;
  Quantity quantity;
};

/// What an amount in the parameter `param` says.
Result<Quantity> quantity_of(const api::Amount& amount, std::string_view param, Dimension dimension,
                             const GatewayAxis& axis) {
  if (const auto* text = std::get_if<std::string>(&amount.said)) {
    const auto quantity = tmcl::parse_quantity(*text);
    if (!quantity) return tl::unexpected(quantity_error(param, quantity.error()));
    const bool needs_unit = quantity->number != 0 && dimension != Dimension::other;
    if (!needs_unit || !quantity->unit.empty() || axis.unit().empty()) return *quantity;
    return tl::unexpected(quantity_error(param, bare_number(*quantity, dimension, axis.unit())));
  }
  if (!axis.unit().empty())
    return Quantity{std::get<double>(amount.said), unit_of(dimension, axis.unit())};
  return tl::unexpected(has_no_unit_of_its_own(axis, param));
}

/// `plain_unit`: empty for what the module counts.
Result<ParsedAmount> parse_amount(const RawOrQuantity& said, const GatewayAxis& axis,
                                  Dimension dimension, const char* plain_unit = "") {
  if (said.plain.has_value() == said.amount.has_value()) {
    const auto names = quoted(said.plain_name) + " or " + quoted(said.amount_name);
    return tl::unexpected(param_error("bad_argument", said.plain_name,
                                      said.plain
                                          ? "give " + names + ", not both"
                                          : "one of the parameters " + names + " is needed"));
  }
  if (said.plain) return ParsedAmount{said.plain_name, {*said.plain, plain_unit}};
  return quantity_of(*said.amount, said.amount_name, dimension, axis).map([&](Quantity quantity) {
    return ParsedAmount{said.amount_name, std::move(quantity)};
  });
}

AxisUnits nothing_read_of(const GatewayAxis& axis) {
  return {axis.name(), axis.module().model(), {}, {}, {}, axis.encoder_counts_per_unit()};
}

/// What the conversion of a quantity needs, read where that is not known. `measures`: what a number
/// without a unit is, where the module's own unit matters for that, too.
Task<AxisUnits> units_for(GatewayAxis& axis, std::string_view param, const Quantity& quantity,
                          Dimension measures = Dimension::other) {
  auto units = nothing_read_of(axis);
  if (!is_in_microsteps(quantity)) {
    auto scale = co_await must(axis.scale(), axis);
    if (!scale) {
      co_return param_error(
          "bad_argument", param,
          "the module of axis " + quoted(axis.name()) + " does not tell its microstep resolution",
          "the configuration can: 'microsteps'");
    }
    units.scale = std::move(scale);
  }
  const auto dimension = quantity.unit.empty() ? measures : dimension_of(quantity);
  if (dimension == Dimension::other || dimension == Dimension::position) co_return units;
  auto module = co_await must(axis.module_units(), axis);
  units.module = module;
  co_return units;
}

template <class Value>
Task<ParsedRate<Value>> rate_of(GatewayAxis& axis, RawOrQuantity either, Dimension dimension,
                                const char* plain_unit,
                                tmcl::Result<Value> (*in_pulses)(const Quantity&,
                                                                 const AxisUnits&)) {
  auto rate_said = co_await must(parse_amount(either, axis, dimension, plain_unit));
  auto& [param, said] = rate_said;
  if (!(said.number > 0)) {
    co_return param_error("out_of_range", param, quoted(param) + " must be greater than 0");
  }
  auto units = co_await must(units_for(axis, param, said, dimension));
  auto undirected = units.undirected();
  const auto rate = in_pulses(said, undirected);
  if (!rate) co_return quantity_error(param, rate.error());
  co_return ParsedRate<Value>{*rate, param, std::move(said), std::move(undirected)};
}

/// `parameter` is what holds such a limit.
template <class Value>
Task<std::optional<Value>> limit_of(GatewayAxis& axis, RawOrQuantity either, Dimension dimension,
                                    const char* plain_unit, std::uint8_t parameter,
                                    tmcl::Result<Value> (*in_pulses)(const Quantity&,
                                                                     const AxisUnits&)) {
  if (!either.plain && !either.amount) co_return std::nullopt;
  const auto limit =
      co_await must(rate_of(axis, std::move(either), dimension, plain_unit, in_pulses));
  const auto* row = find_parameter(axis.parameters(), parameter);
  if (!limit.units.module || row == nullptr) co_return limit.in_pulses;
  auto fits = to_parameter(limit.quantity, limit.units, *row);
  if (fits) co_return limit.in_pulses;
  fits.error().message = "axis " + quoted(axis.name()) + ": " + fits.error().message;
  co_return quantity_error(limit.param, fits.error());
}

}  // namespace

Error quantity_error(std::string_view param, const tmcl::Error& error) {
  return param_error(name_of(error.code), param, error.message, error.hint);
}

Task<ParsedRate<tmcl::PulsesPerSecond>> velocity_rate_of(GatewayAxis& axis, RawOrQuantity said) {
  return rate_of<tmcl::PulsesPerSecond>(axis, std::move(said), Dimension::velocity, "",
                                        tmcl::to_pps);
}

Task<ParsedRate<tmcl::PulsesPerSecond2>> acceleration_rate_of(GatewayAxis& axis,
                                                              RawOrQuantity said) {
  return rate_of<tmcl::PulsesPerSecond2>(axis, std::move(said), Dimension::acceleration, "",
                                         tmcl::to_pps2);
}

namespace {

/// A target beyond what a module can count to is beyond the soft limits as well, and those say how
/// far it may go.
std::optional<Error> objection_by_limits(const GatewayAxis& axis, std::string_view param,
                                         const Quantity& quantity, const AxisUnits& units) {
  const auto& limits = axis.soft_limits();
  const auto own = in_own_unit(quantity, units);
  if (!limits || !own || (*own >= limits->least.value && *own <= limits->greatest.value))
    return std::nullopt;
  const double limit = *own < limits->least.value ? limits->least.value : limits->greatest.value;
  return param_error("beyond_soft_limit", param,
                     "axis " + quoted(axis.name()) + ": " +
                         describe(tmcl::BeyondLimit{*own, limit, units.scale->unit}),
                     "the configuration has it: 'soft_limits'");
}

constexpr std::string_view jerk_param = api::name_of<&api::axis::OfRamp::jerk>();

Result<Quantity> jerk_quantity_of(const api::Amount& said, const GatewayAxis& axis) {
  const auto* text = std::get_if<std::string>(&said.said);
  const auto& unit = axis.unit();
  if (text == nullptr && unit.empty())
    return tl::unexpected(has_no_unit_of_its_own(axis, jerk_param));
  if (text == nullptr) return Quantity{std::get<double>(said.said), unit + "/s^3"};
  const auto quantity = tmcl::parse_quantity(*text);
  if (!quantity) return tl::unexpected(quantity_error(jerk_param, quantity.error()));
  if (!quantity->unit.empty()) return *quantity;
  const auto alone = quoted(*text) + " has no unit";
  const auto in_pulses = *text + "pps/s^2";
  if (unit.empty()) {
    return tl::unexpected(param_error(
        "bare_number", jerk_param, alone,
        in_pulses + ", or a bow of 1 to " + std::to_string(tmcl::greatest_bow) + " for 'bow'"));
  }
  return tl::unexpected(param_error("bare_number", jerk_param, alone + ", and the axis has one",
                                    *text + unit + "/s^3 or " + in_pulses));
}

}  // namespace

Task<ParsedRate<tmcl::PulsesPerSecond3>> jerk_of(GatewayAxis& axis, const api::Amount& said) {
  auto quantity = co_await must(jerk_quantity_of(said, axis));
  const auto units = co_await must(units_for(axis, jerk_param, quantity));
  auto undirected = units.undirected();
  const auto jerk = tmcl::to_pps3(quantity, undirected);
  if (!jerk) co_return quantity_error(jerk_param, jerk.error());
  if (jerk->value > 0) {
    co_return ParsedRate<tmcl::PulsesPerSecond3>{*jerk, jerk_param, std::move(quantity),
                                                 std::move(undirected)};
  }
  co_return param_error("out_of_range", jerk_param, quoted(jerk_param) + " must be greater than 0");
}

namespace {

enum class Measures : std::uint8_t { place, distance };

/// A distance is the same wherever it begins.
Task<ParsedLength> parse_length(GatewayAxis& axis, RawOrQuantity either,
                                const tmcl::ParameterInfo* row, Measures measures) {
  const auto said = co_await must(parse_amount(either, axis, Dimension::position));
  const auto& [param, quantity] = said;
  auto units = co_await must(units_for(axis, param, quantity));
  auto scale = units.scale;
  if (units.scale && measures == Measures::distance) units.scale->correction = nullptr;
  tmcl::ValueRange range;
  if (row != nullptr) range = {row->minimum, row->maximum};
  const auto value = tmcl::to_microsteps(quantity, units, range);
  if (!value && row != nullptr) {
    co_await must_not(objection_by_limits(axis, param, quantity, units));
  }
  if (!value) co_return quantity_error(param, value.error());
  co_await must_not(check_range(row, value->value, param));
  ParsedLength length{*value};
  if (const auto own = in_own_unit(quantity, units)) length.in_unit = tmcl::UserPosition{*own};
  length.scale = std::move(scale);
  co_return length;
}

}  // namespace

Task<ParsedLength> length_of(GatewayAxis& axis, RawOrQuantity said,
                             const tmcl::ParameterInfo* row) {
  return parse_length(axis, std::move(said), row, Measures::place);
}

Task<ParsedLength> distance_of(GatewayAxis& axis, RawOrQuantity said) {
  return parse_length(axis, std::move(said), nullptr, Measures::distance);
}

Task<std::optional<tmcl::PulsesPerSecond>> velocity_limit_of(GatewayAxis& axis,
                                                             RawOrQuantity said) {
  return limit_of<tmcl::PulsesPerSecond>(axis, std::move(said), Dimension::velocity, "pps",
                                         ap::max_velocity, tmcl::to_pps);
}

Task<std::optional<tmcl::PulsesPerSecond2>> acceleration_limit_of(GatewayAxis& axis,
                                                                  RawOrQuantity said) {
  const auto* model = axis.module().model();
  const auto parameter =
      model == nullptr ? ap::max_acceleration : tmcl::plan::acceleration_parameter(*model);
  return limit_of<tmcl::PulsesPerSecond2>(axis, std::move(said), Dimension::acceleration, "pps/s",
                                          parameter, tmcl::to_pps2);
}

namespace {

/// What an answer tells in the unit of the axis: nothing of an axis without one. What has been done
/// does not fail because something could not be read.
awaitable<AxisUnits> units_to_tell(GatewayAxis& axis, AxisUnits units, Dimension dimension) {
  if (axis.unit().empty() || dimension == Dimension::other) {
    units.scale.reset();
    co_return units;
  }
  if (!units.scale) {
    auto scale = co_await axis.scale();
    if (scale) units.scale = std::move(*scale);
  }
  if (units.module || dimension == Dimension::position || !units.scale) co_return units;
  auto module = co_await axis.module_units();
  if (module) units.module = *module;
  co_return units;
}

Error has_no_unit(const ParameterChoice& choice, const RawOrQuantity& said,
                  const Quantity& quantity) {
  const auto* row = choice.row;
  const auto name = choice.name().value_or(std::to_string(choice.number));
  auto message =
      "parameter " + quoted(name) + " is not known to be a position, a velocity or an acceleration";
  auto hint = "give a number without a unit, as " + quoted(said.plain_name);
  if (row != nullptr) {
    const auto greatest = std::to_string(row->maximum);
    hint += ": " + std::to_string(row->minimum) + " to " + greatest;
    if (quantity.unit == "%" && row->minimum == 0)
      hint += "; " + to_string(quantity) + " of " + greatest + " is " +
              std::to_string(std::lround(quantity.number / 100 * row->maximum));
  }
  return param_error("bad_argument", said.amount_name, std::move(message), std::move(hint));
}

/// What the module is to hold in a parameter.
Task<ModuleValue> value_of(GatewayAxis& axis, RawOrQuantity either, Dimension dimension,
                           ParameterChoice choice) {
  const auto said = co_await must(parse_amount(either, axis, dimension));
  const auto& [param, quantity] = said;
  const bool has_unit = choice.row != nullptr && dimension != Dimension::other;
  if (either.amount && !has_unit) co_return has_no_unit(choice, either, quantity);
  auto units = co_await must(units_for(axis, param, quantity));
  const bool is_bare = quantity.unit.empty();
  const bool is_rate = dimension != Dimension::position && dimension_of(quantity) == dimension;
  if (!is_bare && is_rate && !units.module) co_return has_no_unit(choice, either, quantity);
  const auto as_number = [](tmcl::Microsteps count) { return count.value; };
  const auto value = is_bare ? to_microsteps(quantity, units).map(as_number)
                             : to_parameter(quantity, units, *choice.row);
  if (!value) {
    auto error = value.error();
    const auto* model = axis.module().model();
    const bool divided = model != nullptr && model->family == tmcl::Family::tmc429;
    if (is_rate && divided && error.code == tmcl::Errc::out_of_range)
      error.hint =
          "its pulse and ramp divisors allow no more; axis.set_ramp, or 'ramp' on the command "
          "line, chooses others";
    co_return quantity_error(param, error);
  }
  co_await must_not(check_range(is_bare ? choice.row : nullptr, *value, param));
  co_return ModuleValue{*value, std::move(units)};
}

}  // namespace

Task<ModuleValue> velocity_of(GatewayAxis& axis, RawOrQuantity said) {
  const auto* row = find_parameter(axis.parameters(), ap::target_velocity);
  return value_of(axis, std::move(said), Dimension::velocity, {ap::target_velocity, row});
}

Task<ModuleValue> parameter_value_of(GatewayAxis& axis, RawOrQuantity said,
                                     const ParameterChoice& choice) {
  const auto dimension = choice.row == nullptr ? Dimension::other : dimension_of(*choice.row);
  return value_of(axis, std::move(said), dimension, choice);
}

awaitable<InUnit> in_unit(GatewayAxis& axis, std::optional<tmcl::Microsteps> position,
                          const tmcl::UserScale* scale) {
  auto known = nothing_read_of(axis);
  if (scale != nullptr) known.scale = *scale;
  const auto units = co_await units_to_tell(axis, std::move(known), Dimension::position);
  if (!units.scale) co_return InUnit{};
  InUnit told{units.scale->unit};
  if (position) told.number = to_user(*position, *units.scale).value;
  co_return told;
}

awaitable<InUnit> distance_in_unit(GatewayAxis& axis, std::optional<tmcl::Microsteps> distance) {
  auto units = co_await units_to_tell(axis, nothing_read_of(axis), Dimension::position);
  if (!units.scale) co_return InUnit{};
  units.scale->correction = nullptr;
  auto told = co_await in_unit(axis, distance, &*units.scale);
  co_return told;
}

awaitable<InUnit> in_unit(GatewayAxis& axis, const tmcl::ParameterInfo* row, ModuleValue value) {
  const auto dimension = row == nullptr ? Dimension::other : dimension_of(*row);
  auto known = value.units.value_or(nothing_read_of(axis));
  const auto units = co_await units_to_tell(axis, std::move(known), dimension);
  if (row == nullptr || !units.scale) co_return InUnit{};
  const auto in_unit = from_parameter(value.value, units, *row);
  if (!in_unit) co_return InUnit{};
  co_return InUnit{in_unit->unit, in_unit->number};
}

awaitable<InUnit> velocity_in_unit(GatewayAxis& axis, ModuleValue velocity) {
  auto known = velocity.units.value_or(nothing_read_of(axis));
  const auto units = co_await units_to_tell(axis, std::move(known), Dimension::velocity);
  if (!units.scale) co_return InUnit{};
  InUnit told{units.scale->unit};
  if (!units.module) co_return told;
  const auto pps = tmcl::to_pps(tmcl::InternalVelocity{velocity.value}, *units.module);
  told.number = to_user(pps, *units.scale).value;
  co_return told;
}

awaitable<api::axis::Place> place_of(GatewayAxis& axis, tmcl::Microsteps position) {
  auto told = co_await in_unit(axis, position);
  co_return api::axis::Place{position.value, std::move(told.unit), told.number};
}

}  // namespace tmcld

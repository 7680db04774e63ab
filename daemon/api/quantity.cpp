#include "api/quantity.hpp"

#include <utility>

#include "gateway/line.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;
namespace ap = tmcl::axis_parameter;
using boost::asio::awaitable;
using tmcl::AxisUnits;
using tmcl::Dimension;
using tmcl::Quantity;

std::string quoted(std::string_view word) { return "'" + std::string(word) + "'"; }

/// Of a parameter `param`.
RpcError quantity_error(std::string_view param, const tmcl::QuantityError& error) {
  return param_error(error.code, param, error.message, error.hint);
}

/// Two parameters that say the same.
struct Forms {
  std::string_view plain;
  std::string_view quantity;
  Dimension dimension;
  const char* plain_unit = "";  // empty: what the module counts
};
constexpr Forms velocity_forms{"velocity_internal", "velocity", Dimension::velocity};
constexpr Forms velocity_limit{"velocity_pps", "velocity", Dimension::velocity, "pps"};
constexpr Forms acceleration_limit{"acceleration_pps2", "acceleration", Dimension::acceleration,
                                   "pps/s"};

/// What one of them says.
struct Said {
  std::string_view param;
  Quantity quantity;
};

/// What a number or a text of the parameter `param` says.
Lookup<Quantity> quantity_of(const json::value& said, std::string_view param, Dimension dimension,
                             const GatewayAxis& axis) {
  if (said.is_string()) {
    const auto quantity = tmcl::parse_quantity(said.get_string());
    if (!quantity) return tl::unexpected(quantity_error(param, quantity.error()));
    const bool needs_unit = quantity->number != 0 && dimension != Dimension::other;
    if (!needs_unit || !quantity->unit.empty() || axis.unit().empty()) return *quantity;
    return tl::unexpected(quantity_error(param, bare_number(*quantity, dimension, axis.unit())));
  }
  if (!axis.unit().empty())
    return Quantity{said.to_number<double>(), unit_of(dimension, axis.unit())};
  return tl::unexpected(
      param_error("bad_argument", param, "axis " + quoted(axis.name()) + " has no unit of its own",
                  "the configuration gives it one by 'unit' and 'units_per_revolution'; a text "
                  "can be in others, such as '1.5rev'"));
}

Lookup<Said> said_in(const Call& call, const GatewayAxis& axis, const Forms& forms) {
  const bool is_plain = call.params.has(forms.plain);
  if (is_plain == call.params.has(forms.quantity)) {
    const auto either = quoted(forms.plain) + " or " + quoted(forms.quantity);
    return tl::unexpected(param_error("bad_argument", forms.plain,
                                      is_plain ? "give " + either + ", not both"
                                               : "one of the parameters " + either + " is needed"));
  }
  if (is_plain) return Said{forms.plain, {call.params.number(forms.plain), forms.plain_unit}};
  return quantity_of(call.params.value(forms.quantity), forms.quantity, forms.dimension, axis)
      .map([&](Quantity quantity) {
        return Said{forms.quantity, std::move(quantity)};
      });
}

AxisUnits nothing_read_of(const GatewayAxis& axis) {
  return {axis.name(), axis.module().model(), {}, {}, {}, axis.encoder_counts_per_unit()};
}

/// What the conversion of a quantity needs, read where that is not known. `measures`: what a number
/// without a unit is, where the module's own unit matters for that, too.
awaitable<Lookup<AxisUnits>> units_for(GatewayAxis& axis, std::string_view param,
                                       const Quantity& quantity,
                                       Dimension measures = Dimension::other) {
  auto units = nothing_read_of(axis);
  if (!is_in_microsteps(quantity)) {
    auto scale = co_await axis.scale();
    if (!scale) co_return tl::unexpected(call_error(scale.error(), axis.name()));
    if (!*scale) {
      co_return tl::unexpected(param_error(
          "bad_argument", param,
          "the module of axis " + quoted(axis.name()) + " does not tell its microstep resolution",
          "the configuration can: 'microsteps'"));
    }
    units.scale = std::move(*scale);
  }
  const auto dimension = quantity.unit.empty() ? measures : dimension_of(quantity);
  if (dimension == Dimension::other || dimension == Dimension::position) co_return units;
  auto module = co_await axis.module_units();
  if (!module) co_return tl::unexpected(call_error(module.error(), axis.name()));
  units.module = *module;
  co_return units;
}

/// A position as `row` wants it, which may be null.
awaitable<Lookup<SaidLength>> position_of(GatewayAxis& axis, const Said& said,
                                          const tmcl::ParameterInfo* row) {
  const auto& [param, quantity] = said;
  auto units = co_await units_for(axis, param, quantity);
  if (!units) co_return tl::unexpected(units.error());
  tmcl::ValueRange range;
  if (row != nullptr) range = {row->minimum, row->maximum};
  const auto value = tmcl::to_microsteps(quantity, *units, range);
  if (!value) co_return tl::unexpected(quantity_error(param, value.error()));
  if (auto complaint = check_range(row, value->value, param))
    co_return tl::unexpected(std::move(*complaint));
  SaidLength length{*value};
  if (const auto own = in_own_unit(quantity, *units)) length.in_unit = tmcl::UserPosition{*own};
  length.scale = std::move(units->scale);
  co_return length;
}

}  // namespace

awaitable<Lookup<SaidLength>> length_of(const Call& call, GatewayAxis& axis,
                                        std::string_view microsteps, std::string_view quantity,
                                        const tmcl::ParameterInfo* row) {
  const auto said = said_in(call, axis, {microsteps, quantity, Dimension::position});
  if (!said) co_return tl::unexpected(said.error());
  auto length = co_await position_of(axis, *said, row);
  co_return length;
}

awaitable<Lookup<tmcl::Microsteps>> position_for(const Call& call, GatewayAxis& axis,
                                                 std::string_view list, std::size_t index) {
  const auto* row = find_parameter(axis.parameters(), ap::target_position);
  const auto& element = call.params.value(list).get_array().at(index);
  Said said{list, {}};
  if (list == "positions") {
    auto quantity = quantity_of(element, list, Dimension::position, axis);
    if (!quantity) co_return tl::unexpected(std::move(quantity.error()));
    said.quantity = std::move(*quantity);
  } else {
    said.quantity.number = element.to_number<double>();
  }
  const auto place = co_await position_of(axis, said, row);
  if (!place) co_return tl::unexpected(place.error());
  co_return place->microsteps;
}

namespace {

/// `parameter` is what holds such a limit.
template <class Value>
awaitable<Lookup<std::optional<Value>>> limit_of(
    const Call& call, GatewayAxis& axis, Forms forms, std::uint8_t parameter,
    tmcl::Converted<Value> (*in_pulses)(const Quantity&, const AxisUnits&)) {
  if (!call.params.has(forms.plain) && !call.params.has(forms.quantity)) co_return std::nullopt;
  const auto limit_said = said_in(call, axis, forms);
  if (!limit_said) co_return tl::unexpected(limit_said.error());
  const auto& [param, said] = *limit_said;
  if (!(said.number > 0)) {
    co_return tl::unexpected(
        param_error("out_of_range", param, quoted(param) + " must be greater than 0"));
  }
  const auto units = co_await units_for(axis, param, said, forms.dimension);
  if (!units) co_return tl::unexpected(units.error());
  const auto undirected = units->undirected();
  const auto limit = in_pulses(said, undirected);
  if (!limit) co_return tl::unexpected(quantity_error(param, limit.error()));
  const auto* row = find_parameter(axis.parameters(), parameter);
  if (!units->module || row == nullptr) co_return *limit;
  auto fits = to_parameter(said, undirected, *row);
  if (fits) co_return *limit;
  fits.error().message = "axis " + quoted(axis.name()) + ": " + fits.error().message;
  co_return tl::unexpected(quantity_error(param, fits.error()));
}

}  // namespace

awaitable<Lookup<MotionLimits>> motion_limits_of(const Call& call, GatewayAxis& axis) {
  const auto velocity = co_await limit_of<tmcl::PulsesPerSecond>(call, axis, velocity_limit,
                                                                 ap::max_velocity, tmcl::to_pps);
  if (!velocity) co_return tl::unexpected(velocity.error());
  const auto* model = axis.module().model();
  const auto parameter = model == nullptr ? ap::max_acceleration : greatest_acceleration_of(*model);
  const auto acceleration = co_await limit_of<tmcl::PulsesPerSecond2>(
      call, axis, acceleration_limit, parameter, tmcl::to_pps2);
  if (!acceleration) co_return tl::unexpected(acceleration.error());
  co_return MotionLimits{*velocity, *acceleration};
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

RpcError has_no_unit(const ParameterChoice& choice, const Forms& forms) {
  const auto name =
      choice.row == nullptr ? std::to_string(choice.number) : std::string(choice.row->name);
  return param_error(
      "bad_argument", forms.quantity,
      "parameter " + quoted(name) + " is not known to be a position, a velocity or an acceleration",
      "give " + quoted(forms.plain));
}

/// What the module is to hold in a parameter.
awaitable<Lookup<ModuleValue>> value_of(const Call& call, GatewayAxis& axis, Forms forms,
                                        const ParameterChoice& choice) {
  const auto said = said_in(call, axis, forms);
  if (!said) co_return tl::unexpected(said.error());
  const auto& [param, quantity] = *said;
  const bool has_unit = choice.row != nullptr && forms.dimension != Dimension::other;
  if (param == forms.quantity && !has_unit) co_return tl::unexpected(has_no_unit(choice, forms));
  auto units = co_await units_for(axis, param, quantity);
  if (!units) co_return tl::unexpected(units.error());
  const bool is_bare = quantity.unit.empty();
  if (!is_bare && forms.dimension != Dimension::position && !units->module)
    co_return tl::unexpected(has_no_unit(choice, forms));
  const auto as_number = [](tmcl::Microsteps count) { return count.value; };
  const auto value = is_bare ? to_microsteps(quantity, *units).map(as_number)
                             : to_parameter(quantity, *units, *choice.row);
  if (!value) co_return tl::unexpected(quantity_error(param, value.error()));
  auto complaint = check_range(is_bare ? choice.row : nullptr, *value, param);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  co_return ModuleValue{*value, std::move(*units)};
}

}  // namespace

awaitable<Lookup<ModuleValue>> velocity_of(const Call& call, GatewayAxis& axis) {
  const auto* row = find_parameter(axis.parameters(), ap::target_velocity);
  const ParameterChoice target{ap::target_velocity, row};
  auto value = co_await value_of(call, axis, velocity_forms, target);
  co_return value;
}

awaitable<Lookup<ModuleValue>> parameter_value_of(const Call& call, GatewayAxis& axis,
                                                  const ParameterChoice& choice) {
  const auto dimension = choice.row == nullptr ? Dimension::other : dimension_of(*choice.row);
  const Forms forms{"value", "value_in_unit", dimension};
  auto value = co_await value_of(call, axis, forms, choice);
  co_return value;
}

awaitable<void> add_in_unit(json::object& result, GatewayAxis& axis, std::string_view key,
                            std::optional<tmcl::Microsteps> position,
                            const tmcl::UserScale* scale) {
  result["unit"] = nullptr;
  result[key] = nullptr;
  auto known = nothing_read_of(axis);
  if (scale != nullptr) known.scale = *scale;
  const auto units = co_await units_to_tell(axis, std::move(known), Dimension::position);
  if (!units.scale) co_return;
  result["unit"] = units.scale->unit;
  if (position) result[key] = to_user(*position, *units.scale).value;
}

awaitable<void> add_in_unit(json::object& result, GatewayAxis& axis, const tmcl::ParameterInfo* row,
                            ModuleValue value) {
  result["unit"] = nullptr;
  result["value_in_unit"] = nullptr;
  const auto dimension = row == nullptr ? Dimension::other : dimension_of(*row);
  auto known = value.units.value_or(nothing_read_of(axis));
  const auto units = co_await units_to_tell(axis, std::move(known), dimension);
  if (row == nullptr || !units.scale) co_return;
  const auto in_unit = from_parameter(value.value, units, *row);
  if (!in_unit) co_return;
  result["unit"] = in_unit->unit;
  result["value_in_unit"] = in_unit->number;
}

awaitable<void> add_velocity_in_unit(json::object& result, GatewayAxis& axis,
                                     ModuleValue velocity) {
  result["unit"] = nullptr;
  result["velocity"] = nullptr;
  auto known = velocity.units.value_or(nothing_read_of(axis));
  const auto units = co_await units_to_tell(axis, std::move(known), Dimension::velocity);
  if (!units.scale) co_return;
  result["unit"] = units.scale->unit;
  if (!units.module) co_return;
  const auto pps = tmcl::to_pps(tmcl::InternalVelocity{velocity.value}, *units.module);
  result["velocity"] = to_user(pps, *units.scale).value;
}

}  // namespace tmcld

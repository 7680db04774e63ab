#include "api/quantity.hpp"

#include <utility>

#include "gateway/line.hpp"
#include "tmcl/conversion.hpp"
#include "tmcl/parameter_units.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;
using boost::asio::awaitable;

std::string quoted(std::string_view word) { return "'" + std::string(word) + "'"; }

std::optional<RpcError> check_forms(const Call& call, std::string_view plain,
                                    std::string_view in_unit) {
  if (call.params.has(plain) != call.params.has(in_unit)) return std::nullopt;
  const auto forms = quoted(plain) + " or " + quoted(in_unit);
  return param_error("bad_argument", plain,
                     call.params.has(plain) ? "give " + forms + ", not both"
                                            : "one of the parameters " + forms + " is needed");
}

/// What stands in the parameter `plain`, in the module's own unit; nothing if `in_unit` is given.
Lookup<std::optional<std::int32_t>> plain_value(const Call& call, std::string_view plain,
                                                std::string_view in_unit,
                                                const tmcl::ParameterInfo* row) {
  if (auto complaint = check_forms(call, plain, in_unit))
    return tl::unexpected(std::move(*complaint));
  if (!call.params.has(plain)) return std::optional<std::int32_t>();
  const auto value = call.params.integer(plain);
  if (auto complaint = check_range(row, value, plain)) return tl::unexpected(std::move(*complaint));
  return std::optional(value);
}

RpcError out_of_range(std::string_view param, const tmcl::OutOfReach& error) {
  return param_error("out_of_range", param, describe(error));
}

awaitable<Lookup<std::optional<tmcl::ModuleUnits>>> units_of(GatewayAxis& axis) {
  auto units = co_await axis.module_units();
  if (!units) co_return tl::unexpected(call_error(units.error(), axis.name()));
  co_return *units;
}

awaitable<Lookup<tmcl::UserScale>> user_scale(GatewayAxis& axis, std::string_view param) {
  if (axis.unit().empty()) {
    co_return tl::unexpected(param_error(
        "bad_argument", param, "axis " + quoted(axis.name()) + " has no unit of its own",
        "the configuration gives it one by 'unit' and 'units_per_revolution'"));
  }
  auto scale = co_await axis.scale();
  if (!scale) co_return tl::unexpected(call_error(scale.error(), axis.name()));
  if (*scale) co_return std::move(**scale);
  co_return tl::unexpected(param_error(
      "bad_argument", param,
      "the module of axis " + quoted(axis.name()) + " does not tell its microstep resolution",
      "the configuration can: 'microsteps'"));
}

}  // namespace

namespace {

awaitable<Lookup<tmcl::Microsteps>> in_microsteps(GatewayAxis& axis, std::string_view param,
                                                  tmcl::UserPosition wish,
                                                  const tmcl::ParameterInfo* row) {
  const auto scale = co_await user_scale(axis, param);
  if (!scale) co_return tl::unexpected(scale.error());
  tmcl::ValueRange range;
  if (row != nullptr) range = {row->minimum, row->maximum};
  const auto value = tmcl::to_microsteps(wish, *scale, range);
  if (!value) co_return tl::unexpected(out_of_range(param, value.error()));
  co_return *value;
}

}  // namespace

awaitable<Lookup<Length>> length_of(const Call& call, GatewayAxis& axis,
                                    std::string_view microsteps, std::string_view in_unit,
                                    const tmcl::ParameterInfo* row) {
  const auto plain = plain_value(call, microsteps, in_unit, row);
  if (!plain) co_return tl::unexpected(plain.error());
  if (*plain) co_return Length{{**plain}};
  const tmcl::UserPosition wish{call.params.number(in_unit)};
  const auto value = co_await in_microsteps(axis, in_unit, wish, row);
  if (!value) co_return tl::unexpected(value.error());
  co_return Length{*value, wish};
}

awaitable<Lookup<tmcl::Microsteps>> position_for(const Call& call, GatewayAxis& axis,
                                                 std::string_view list, std::size_t index) {
  const auto* row = find_parameter(axis.parameters(), tmcl::axis_parameter::target_position);
  const double number = call.params.number_at(list, index);
  if (list == "positions") {
    auto value = co_await in_microsteps(axis, list, {number}, row);
    co_return value;
  }
  const auto value = static_cast<std::int32_t>(number);
  if (auto complaint = check_range(row, value, list))
    co_return tl::unexpected(std::move(*complaint));
  co_return tmcl::Microsteps{value};
}

namespace {

/// One of two forms of a limit, as it was said.
struct SaidLimit {
  std::string_view param;
  double value;
  bool in_unit;
};

Lookup<std::optional<SaidLimit>> said_limit(const Call& call, std::string_view in_unit,
                                            std::string_view plain) {
  if (!call.params.has(in_unit) && !call.params.has(plain)) return std::nullopt;
  if (auto complaint = check_forms(call, plain, in_unit))
    return tl::unexpected(std::move(*complaint));
  const bool has_unit = call.params.has(in_unit);
  const auto param = has_unit ? in_unit : plain;
  const SaidLimit said{param, call.params.number(param), has_unit};
  if (said.value > 0) return said;
  return tl::unexpected(
      param_error("out_of_range", param, quoted(param) + " must be greater than 0"));
}

/// A velocity or an acceleration, and its two forms.
template <class Value>
struct LimitKind {
  std::string_view in_unit;
  std::string_view plain;
  Value (*from_unit)(double, const tmcl::UserScale&);
  tmcl::OutOfReach (*told_in_unit)(const tmcl::OutOfReach&, const tmcl::UserScale&);
};
constexpr LimitKind<tmcl::PulsesPerSecond> velocity_limit{
    "velocity", "velocity_pps",
    [](double value, const tmcl::UserScale& scale) {
      return tmcl::to_pps(tmcl::UserVelocity{value}, scale);
    },
    tmcl::in_velocity_units};
constexpr LimitKind<tmcl::PulsesPerSecond2> acceleration_limit{
    "acceleration", "acceleration_pps2",
    [](double value, const tmcl::UserScale& scale) {
      return tmcl::to_pps2(tmcl::UserAcceleration{value}, scale);
    },
    tmcl::in_acceleration_units};

/// `parameter` is what holds such a limit.
template <class Value>
awaitable<Lookup<std::optional<Value>>> limit_of(const Call& call, GatewayAxis& axis,
                                                 const LimitKind<Value>& kind,
                                                 std::uint8_t parameter) {
  const auto said = said_limit(call, kind.in_unit, kind.plain);
  if (!said) co_return tl::unexpected(said.error());
  if (!*said) co_return std::nullopt;
  const auto [param, value, in_unit] = **said;
  std::optional<tmcl::UserScale> scale;
  if (in_unit) {
    auto known = co_await user_scale(axis, param);
    if (!known) co_return tl::unexpected(known.error());
    scale = std::move(*known);
    scale->reverse = false;  // a limit holds in both directions
  }
  const auto limit = scale ? kind.from_unit(value, *scale) : Value{value};
  const auto known = co_await units_of(axis);
  if (!known) co_return tl::unexpected(known.error());
  const auto& units = *known;
  const auto* row = find_parameter(axis.parameters(), parameter);
  if (!units || row == nullptr) co_return limit;
  const auto start = tmcl::initial_units(*axis.module().model());
  const auto fits = tmcl::to_internal(limit, *units, range_of(*row, start, *units));
  if (fits) co_return limit;
  const auto error = scale ? kind.told_in_unit(fits.error(), *scale) : fits.error();
  co_return tl::unexpected(
      param_error("out_of_range", param, "axis " + quoted(axis.name()) + ": " + describe(error)));
}

}  // namespace

awaitable<Lookup<MotionLimits>> motion_limits_of(const Call& call, GatewayAxis& axis) {
  const auto velocity =
      co_await limit_of(call, axis, velocity_limit, tmcl::axis_parameter::max_velocity);
  if (!velocity) co_return tl::unexpected(velocity.error());
  const auto* model = axis.module().model();
  const auto parameter =
      model == nullptr ? tmcl::axis_parameter::max_acceleration : greatest_acceleration_of(*model);
  const auto acceleration = co_await limit_of(call, axis, acceleration_limit, parameter);
  if (!acceleration) co_return tl::unexpected(acceleration.error());
  co_return MotionLimits{*velocity, *acceleration};
}

awaitable<Lookup<tmcl::InternalVelocity>> velocity_of(const Call& call, GatewayAxis& axis) {
  constexpr std::string_view in_unit = "velocity";
  const auto* row = find_parameter(axis.parameters(), tmcl::axis_parameter::target_velocity);
  const auto plain = plain_value(call, "velocity_internal", in_unit, row);
  if (!plain) co_return tl::unexpected(plain.error());
  if (*plain) co_return tmcl::InternalVelocity{**plain};
  const auto scale = co_await user_scale(axis, in_unit);
  if (!scale) co_return tl::unexpected(scale.error());
  const auto known = co_await units_of(axis);
  if (!known) co_return tl::unexpected(known.error());
  const auto& units = *known;
  if (!units || row == nullptr) {
    co_return tl::unexpected(param_error(
        "bad_argument", in_unit,
        "what the module of axis " + quoted(axis.name()) + " counts velocities in is not known",
        "give 'velocity_internal'"));
  }
  const auto start = tmcl::initial_units(*axis.module().model());
  const tmcl::UserVelocity wish{call.params.number(in_unit)};
  const auto value =
      tmcl::to_internal(tmcl::to_pps(wish, *scale), *units, range_of(*row, start, *units));
  if (!value)
    co_return tl::unexpected(out_of_range(in_unit, in_velocity_units(value.error(), *scale)));
  co_return *value;
}

namespace {

/// Nothing for an axis without a unit, and where the microsteps of a turn are not known. What has
/// been done does not fail because they could not be read.
awaitable<std::optional<tmcl::UserScale>> unit_scale(GatewayAxis& axis) {
  if (axis.unit().empty()) co_return std::nullopt;
  auto scale = co_await axis.scale();
  co_return scale ? std::move(*scale) : std::nullopt;
}

tmcl::AxisScale axis_scale(const GatewayAxis& axis, tmcl::UserScale scale,
                           std::optional<tmcl::ModuleUnits> units) {
  return {axis.module().model(), std::move(scale), units, axis.encoder_counts_per_unit()};
}

RpcError has_no_unit(const ParameterChoice& choice) {
  const auto name =
      choice.row == nullptr ? std::to_string(choice.number) : std::string(choice.row->name);
  return param_error(
      "bad_argument", "value_in_unit",
      "parameter " + quoted(name) + " is not known to be a position, a velocity or an acceleration",
      "give 'value'");
}

}  // namespace

awaitable<Lookup<std::int32_t>> parameter_value_of(const Call& call, GatewayAxis& axis,
                                                   const ParameterChoice& choice) {
  constexpr std::string_view in_unit = "value_in_unit";
  const auto plain = plain_value(call, "value", in_unit, choice.row);
  if (!plain) co_return tl::unexpected(plain.error());
  if (*plain) co_return **plain;
  auto scale = co_await user_scale(axis, in_unit);
  if (!scale) co_return tl::unexpected(scale.error());
  const auto* row = choice.row;
  if (row == nullptr || unit_of(*row, scale->unit).empty())
    co_return tl::unexpected(has_no_unit(choice));
  const auto units = co_await units_of(axis);
  if (!units) co_return tl::unexpected(units.error());
  const auto in_module = axis_scale(axis, std::move(*scale), *units);
  // That it has a unit, and only what its module counts in is not known.
  if (!to_user(0, *row, in_module)) co_return tl::unexpected(has_no_unit(choice));
  const auto value = to_parameter(call.params.number(in_unit), *row, in_module);
  if (!value) co_return tl::unexpected(out_of_range(in_unit, value.error()));
  co_return *value;
}

awaitable<void> add_in_unit(json::object& result, GatewayAxis& axis, std::string_view key,
                            std::optional<tmcl::Microsteps> position) {
  result["unit"] = nullptr;
  result[key] = nullptr;
  const auto scale = co_await unit_scale(axis);
  if (!scale) co_return;
  result["unit"] = scale->unit;
  if (position) result[key] = to_user(*position, *scale).value;
}

awaitable<void> add_in_unit(json::object& result, GatewayAxis& axis, const tmcl::ParameterInfo* row,
                            std::int32_t value) {
  result["unit"] = nullptr;
  result["value_in_unit"] = nullptr;
  if (row == nullptr || dimension_of(*row) == tmcl::Dimension::other) co_return;
  auto scale = co_await unit_scale(axis);
  if (!scale) co_return;
  const auto units = co_await axis.module_units();
  const auto in_module = axis_scale(axis, std::move(*scale), units.value_or(std::nullopt));
  const auto in_unit = to_user(value, *row, in_module);
  if (!in_unit) co_return;
  result["unit"] = in_unit->unit;
  result["value_in_unit"] = in_unit->value;
}

awaitable<void> add_in_unit(json::object& result, GatewayAxis& axis,
                            tmcl::InternalVelocity velocity) {
  result["unit"] = nullptr;
  result["velocity"] = nullptr;
  const auto scale = co_await unit_scale(axis);
  if (!scale) co_return;
  const auto units = co_await axis.module_units();
  result["unit"] = scale->unit;
  if (units && *units) result["velocity"] = to_user(to_pps(velocity, **units), *scale).value;
}

}  // namespace tmcld

/// Positions, velocities and accelerations of a call. A JSON number is in the unit of the axis or
/// in what the parameter's name says; a JSON text has its unit with it (tmcl/quantity.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/asio/awaitable.hpp>
#include <boost/json/object.hpp>

#include "api/call.hpp"
#include "api/lookup.hpp"
#include "tmcl/quantity.hpp"

namespace tmcld {

/// What the module is to hold, and what was read to know it: nothing where nothing was.
struct ModuleValue {
  std::int32_t value = 0;
  std::optional<tmcl::AxisUnits> units{};
};

/// A position or a distance, likewise.
struct SaidLength {
  tmcl::Microsteps microsteps;
  std::optional<tmcl::UserPosition> in_unit{};
  std::optional<tmcl::UserScale> scale{};

  const tmcl::UserScale* known_scale() const { return scale ? &*scale : nullptr; }
  Length length() const { return {microsteps, in_unit}; }
};

/// One of two parameters: whole microsteps, or a quantity. `row` is what holds the position; null:
/// any will do. Errors: neither or both are there, what tmcl::to_parameter() objects to, an axis
/// without a unit.
boost::asio::awaitable<Lookup<SaidLength>> length_of(const Call& call, GatewayAxis& axis,
                                                     std::string_view microsteps,
                                                     std::string_view quantity,
                                                     const tmcl::ParameterInfo* row);

/// An element of "positions_microsteps", or of "positions": within the range of target_position.
boost::asio::awaitable<Lookup<tmcl::Microsteps>> position_for(const Call& call, GatewayAxis& axis,
                                                              std::string_view list,
                                                              std::size_t index);

/// What an axis may do at most.
struct MotionLimits {
  std::optional<tmcl::PulsesPerSecond> velocity;
  std::optional<tmcl::PulsesPerSecond2> acceleration;
};
/// The parameters "velocity" and "acceleration", or "velocity_pps" and "acceleration_pps2". Nothing
/// for what is absent. Errors: both forms of one; not above 0, or above what the axis can do.
boost::asio::awaitable<Lookup<MotionLimits>> motion_limits_of(const Call& call, GatewayAxis& axis);

/// The parameter "velocity_internal" or the parameter "velocity".
boost::asio::awaitable<Lookup<ModuleValue>> velocity_of(const Call& call, GatewayAxis& axis);

/// The parameter "value", or the parameter "value_in_unit" as its module wants it.
boost::asio::awaitable<Lookup<ModuleValue>> parameter_value_of(const Call& call, GatewayAxis& axis,
                                                               const ParameterChoice& choice);

// What is told in the unit of the axis, beside what its module counts: null for an axis without
// one, and where the conversion is not known or could not be read. What was read for this call
// before need not be read again.

/// "unit", and the position as `key`.
boost::asio::awaitable<void> add_in_unit(boost::json::object& result, GatewayAxis& axis,
                                         std::string_view key,
                                         std::optional<tmcl::Microsteps> position,
                                         const tmcl::UserScale* scale = nullptr);
/// "unit" and "value_in_unit" of a parameter; null also for one that is neither a position nor a
/// velocity nor an acceleration. `row` may be null.
boost::asio::awaitable<void> add_in_unit(boost::json::object& result, GatewayAxis& axis,
                                         const tmcl::ParameterInfo* row, ModuleValue value);
/// "unit" and "velocity".
boost::asio::awaitable<void> add_velocity_in_unit(boost::json::object& result, GatewayAxis& axis,
                                                  ModuleValue velocity);

}  // namespace tmcld

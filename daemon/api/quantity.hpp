/// Positions and velocities of a call, which may come in the unit of the axis as well.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include <boost/asio/awaitable.hpp>
#include <boost/json/object.hpp>

#include "api/call.hpp"
#include "api/lookup.hpp"

namespace tmcld {

/// One of two parameters: whole microsteps, or a number in the unit of the axis. `row` is what
/// holds the position; null: any will do. Errors: neither or both are there, the axis has no unit,
/// the row's range.
boost::asio::awaitable<Lookup<Length>> length_of(const Call& call, GatewayAxis& axis,
                                                 std::string_view microsteps,
                                                 std::string_view in_unit,
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
/// The parameters "velocity" and "acceleration", in the axis' unit, or "velocity_pps" and
/// "acceleration_pps2". Nothing for what is absent. Errors: both forms of one; not above 0, or
/// above what the axis can do.
boost::asio::awaitable<Lookup<MotionLimits>> motion_limits_of(const Call& call, GatewayAxis& axis);

/// The parameter "velocity_internal" or the parameter "velocity".
boost::asio::awaitable<Lookup<tmcl::InternalVelocity>> velocity_of(const Call& call,
                                                                   GatewayAxis& axis);

/// The parameter "value", or the parameter "value_in_unit" as its module wants it.
boost::asio::awaitable<Lookup<std::int32_t>> parameter_value_of(const Call& call, GatewayAxis& axis,
                                                                const ParameterChoice& choice);

// What is told in the unit of the axis, beside what its module counts: null for an axis without
// one, and where the conversion is not known or could not be read.

/// "unit", and the position as `key`.
boost::asio::awaitable<void> add_in_unit(boost::json::object& result, GatewayAxis& axis,
                                         std::string_view key,
                                         std::optional<tmcl::Microsteps> position);
/// "unit" and "value_in_unit" of a parameter; null also for one that is neither a position nor a
/// velocity nor an acceleration. `row` may be null.
boost::asio::awaitable<void> add_in_unit(boost::json::object& result, GatewayAxis& axis,
                                         const tmcl::ParameterInfo* row, std::int32_t value);
/// "unit" and "velocity".
boost::asio::awaitable<void> add_in_unit(boost::json::object& result, GatewayAxis& axis,
                                         tmcl::InternalVelocity velocity);

}  // namespace tmcld

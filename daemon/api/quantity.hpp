/// Positions and velocities of a call, which may come in the unit of the axis as well.
#pragma once

#include <string_view>

#include <boost/asio/awaitable.hpp>

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

/// The parameter "velocity_internal" or the parameter "velocity".
boost::asio::awaitable<Lookup<tmcl::InternalVelocity>> velocity_of(const Call& call,
                                                                   GatewayAxis& axis);

}  // namespace tmcld

/// Why an axis stands short of its target.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "tmcl/address.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

enum class StopCause : std::uint8_t {
  stall,
  deviation,  ///< Its encoder says that it is not where it should be.
  left_limit,
  right_limit,
  deadman,        ///< Its module has: tmcld had sent it nothing for too long.
  supply,         ///< Its module has started again.
  client,         ///< A client has sent a stop.
  lease_lost,     ///< The program that had it alone has gone, or said nothing for too long.
  search_limit,   ///< Its reference search went further one way than it may.
  daemon,         ///< tmcld has: on a line or path, or when it could not stop it before.
  velocity_mode,  ///< Another master has, or a program in the module: it turns with a speed of 0.
  unknown,        ///< Its module does not say.
};
/// snake_case; part of the stable interface.
std::string_view name_of(StopCause cause);

/// What the module of an axis says, which has these parameters. Reading clears some of it.
/// Errors: those of the exchanges.
tmcl::Script<tmcl::Result<StopCause>> find_stop_cause(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

}  // namespace tmcld

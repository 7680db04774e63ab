/// Why an axis stands that was on its way, and that nobody has stopped.
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
  supply,   ///< Its module has started again.
  client,   ///< Somebody has sent a stop.
  daemon,   ///< tmcld has: on a line or path, or when it could not stop it before.
  unknown,  ///< Its module does not say: another master perhaps, or a program in the module.
};
/// snake_case; part of the stable interface.
std::string_view name_of(StopCause cause);

/// What the module of an axis says, which has these parameters. Reading clears some of it.
/// Errors: those of the exchanges.
tmcl::Script<tmcl::Result<StopCause>> find_stop_cause(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

}  // namespace tmcld

/// What a raw command means to the axis that it names, and what is sent instead of a relative move.
#pragma once

#include <functional>
#include <optional>

#include "gateway/authority/axis_admission.hpp"
#include "tmcl/module_traits.hpp"

namespace tmcld {

/// Nothing of what neither moves an axis nor can set it off. What takes its value from an
/// accumulator or the EEPROM, unseen here, is taken for a Restore.
std::optional<AxisAction> action_of(const tmcl::Request& request);

/// MVP REL.
bool is_relative_move(const tmcl::Request& request);

struct RelativeMove {
  /// The axis parameter that the distance is added to.
  std::uint8_t origin = tmcl::axis_parameter::actual_position;
  /// What the answer has for its value.
  tmcl::RelativeAnswer answer = tmcl::RelativeAnswer::target;
  /// Told where it goes, before that is sent; may be empty.
  std::function<void(tmcl::Microsteps target)> aim{};
};

/// If MVP REL came twice, the motor would go twice as far: read, add, and send where that is.
/// Errors: Errc::bad_argument beyond 32 bits; when the reading fails nothing has moved.
tmcl::Script<tmcl::Result<tmcl::Answer>> move_relatively(tmcl::Request request, RelativeMove move);

/// MVP COORD of one motor.
bool is_move_to_coordinate(const tmcl::Request& request);

/// The module may hold another coordinate by the time it reads it: read it, and send the motor to
/// what was read. `aim`: told where it goes, before that is sent.
tmcl::Script<tmcl::Result<tmcl::Answer>> move_to_read_coordinate(
    tmcl::Request request, std::function<void(tmcl::Microsteps target)> aim);

}  // namespace tmcld

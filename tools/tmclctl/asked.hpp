/// The quantities of a command line as the module of the axis wants them. The axis is asked what it
/// counts in only if a unit was typed.
#pragma once

#include "target.hpp"

namespace tmclctl {

/// Within the range of the parameter target_position.
Attempt<Length> asked_position(const Quantity& position, const std::string& axis, Target& target);
Attempt<Length> asked_distance(const Quantity& distance, const std::string& axis, Target& target);
/// Within the range of the parameter target_velocity.
Attempt<tmcl::InternalVelocity> asked_velocity(const Quantity& velocity, const std::string& axis,
                                               Target& target);
/// A parameter that was read, in the unit of the axis.
Attempt<Quantity> shown_value(const ParameterValue& value, const std::string& axis, Target& target);
Attempt<std::int32_t> asked_value(const Quantity& value, const std::string& axis,
                                  const std::string& parameter, Target& target);

}  // namespace tmclctl

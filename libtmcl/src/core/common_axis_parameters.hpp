/// Axis parameters that are the same in several families.
#pragma once

#include "core/parameter_row.hpp"

namespace tmcl::row {

// clang-format off
inline constexpr ParameterInfo position_reached{
    8, "position_reached", {"position_reached_flag", ""}, r, false, 0, 1, 0, "flag",
    "1 while the actual position equals the target"};
inline constexpr ParameterInfo home_switch{
    9, "home_switch", {"reference_switch_status", ""}, r, false, 0, 1, 0, "flag",
    "state of the home switch"};
inline constexpr ParameterInfo right_switch{
    10, "right_limit_switch", {"right_endstop", ""}, r, false, 0, 1, 0, "flag",
    "state of the right limit switch"};
inline constexpr ParameterInfo left_switch{
    11, "left_limit_switch", {"left_endstop", ""}, r, false, 0, 1, 0, "flag",
    "state of the left limit switch"};
inline constexpr ParameterInfo right_switch_disable{
    12, "right_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag",
    "1: the right limit switch does not stop"};
inline constexpr ParameterInfo left_switch_disable{
    13, "left_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag",
    "1: the left limit switch does not stop"};
inline constexpr ParameterInfo microstep_resolution{
    140, "microstep_resolution", {"usrs", ""}, rw, true, 0, 8, 8, "2^n",
    "microsteps of a full step, as an exponent of two"};
// clang-format on

}  // namespace tmcl::row

/// Numbers of axis parameters by their standard names, for code that means certain ones. A name
/// that is not in this list does not compile, nor does a table of parameters that differs from it.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcl {

/// Bits, in the order of Family.
using FamilySet = std::uint8_t;
constexpr FamilySet set_of(Family family) {
  return static_cast<FamilySet>(1U << static_cast<unsigned>(family));
}

struct ParameterNumber {
  std::string_view name;
  std::uint8_t number;
  FamilySet families;  ///< All on which the name has this number.
};

namespace numbered {

inline constexpr FamilySet tmc429 = set_of(Family::tmc429);
inline constexpr FamilySet tmc457 = set_of(Family::tmc457);
inline constexpr FamilySet sixpoint = set_of(Family::sixpoint);
inline constexpr FamilySet tmc4361 = set_of(Family::tmc4361);
inline constexpr FamilySet firmware = set_of(Family::firmware);
inline constexpr FamilySet all = tmc429 | tmc457 | sixpoint | tmc4361 | firmware;
inline constexpr FamilySet all_but_tmc457 = tmc429 | sixpoint | tmc4361 | firmware;

inline constexpr ParameterNumber list[] = {
    {"target_position", axis_parameter::target_position, all},
    {"actual_position", axis_parameter::actual_position, all},
    {"target_velocity", axis_parameter::target_velocity, all},
    {"actual_velocity", axis_parameter::actual_velocity, all},
    {"max_velocity", axis_parameter::max_velocity, all},
    {"max_acceleration", axis_parameter::max_acceleration, all},
    {"max_current", 6, all},
    {"standby_current", 7, all},
    {"position_reached", axis_parameter::position_reached, all},
    {"home_switch", 9, all},
    {"right_limit_switch", 10, all},
    {"left_limit_switch", 11, all},
    {"right_limit_switch_disable", 12, all},
    {"left_limit_switch_disable", 13, all},
    {"ramp_type", 14, tmc4361},
    {"swap_limit_switches", 14, sixpoint},
    {"swap_limit_switches", 33, tmc4361},
    {"acceleration_a1", 15, sixpoint},
    {"stop_deceleration", 15, tmc457},
    {"stop_deceleration", 21, tmc4361},
    {"acceleration", 16, tmc457},
    {"start_acceleration", 16, tmc4361},
    {"velocity_v1", 16, sixpoint},
    {"max_deceleration", 17, tmc457 | sixpoint | tmc4361},
    {"break_velocity", 18, tmc4361},
    {"deceleration_d1", 18, sixpoint},
    {"max_bow", 18, tmc457},
    {"final_deceleration", 19, tmc4361},
    {"start_velocity", 15, tmc4361},
    {"start_velocity", 19, sixpoint},
    {"stop_velocity", 20, sixpoint | tmc4361},
    {"ramp_wait_time", 21, sixpoint},
    {"bow1", 22, tmc4361},
    {"bow2", 23, tmc4361},
    {"bow3", 24, tmc4361},
    {"bow4", 25, tmc4361},
    {"right_limit_switch_polarity", 24, sixpoint},
    {"left_limit_switch_polarity", 25, sixpoint},
    {"soft_stop", 26, sixpoint},
    {"soft_stop", 34, tmc4361},
    {"soft_stop", 149, tmc429},
    {"measured_speed", 29, sixpoint},
    {"measured_speed", 131, tmc4361 | firmware},
    {"encoder_position", 41, tmc457},
    {"encoder_position", 209, all_but_tmc457},
    {"relative_positioning_option", 127, sixpoint | tmc4361 | firmware},
    {"ramp_mode", 128, tmc457 | firmware},
    {"ramp_mode", 138, tmc429},
    {"status_flags", 129, tmc457},
    {"closed_loop_mode", 129, tmc4361 | firmware},
    {"minimum_velocity", 130, tmc429 | firmware},
    {"velocity_reached", 130, tmc457},
    {"encoder_initialization", 132, firmware},
    {"closed_loop_init_flag", 133, tmc4361 | firmware},
    {"actual_acceleration", 135, tmc429},
    {"microstep_resolution", axis_parameter::microstep_resolution, all},
    {"end_switch_power_down", 150, tmc429},
    {"ramp_divisor", 153, tmc429},
    {"pulse_divisor", 154, tmc429},
    {"toff", 167, all_but_tmc457},
    {"smart_energy_current_minimum", 168, all_but_tmc457},
    {"smart_energy_current_down_step", 169, all_but_tmc457},
    {"smart_energy_hysteresis", 170, all_but_tmc457},
    {"smart_energy_current_up_step", 171, all_but_tmc457},
    {"smart_energy_hysteresis_start", 172, all_but_tmc457},
    {"stallguard2_threshold", 174, all_but_tmc457},
    {"short_protection_disable", 177, all_but_tmc457},
    {"global_current_scaler", 178, sixpoint},
    {"vsense", 179, all_but_tmc457},
    {"smart_energy_actual_current", 180, all_but_tmc457},
    {"smart_energy_stall_velocity", 181, all_but_tmc457},
    {"smart_energy_threshold_speed", 182, all_but_tmc457},
    {"smart_energy_slow_run_current", 183, tmc429 | tmc4361 | firmware},
    {"reference_search_mode", 193, all},
    {"reference_search_speed", 194, all},
    {"reference_switch_speed", 195, all},
    {"reference_switch_distance", 196, all},
    {"last_reference_position", 197, all_but_tmc457},
    {"latched_actual_position", 198, sixpoint | tmc4361},
    {"latched_encoder_position", 199, sixpoint | tmc4361},
    {"boost_current", 200, tmc429 | tmc4361 | firmware},
    {"freewheeling_delay", 204, tmc429 | firmware},
    {"load_value", 206, all_but_tmc457},
    {"extended_error_flags", 207, all},
    {"driver_status_flags", 208, all_but_tmc457},
    {"encoder_resolution", 210, all_but_tmc457},
    {"max_encoder_deviation", 212, all},
    {"group_index", 213, tmc429 | sixpoint},
    {"group_index", 249, tmc4361},
    {"power_down_delay", 214, all_but_tmc457},
    {"absolute_encoder_value", 215, all_but_tmc457},
    {"external_encoder_position", 216, tmc429 | sixpoint},
    {"external_encoder_resolution", 217, sixpoint},
    {"external_encoder_max_deviation", 218, tmc429 | sixpoint},
    {"reverse_shaft", 251, sixpoint | tmc4361},
    {"unit_mode", axis_parameter::unit_mode, tmc457 | sixpoint},
};

// By value: with sanitizers g++ 12 compares no address in a constant expression.
constexpr std::optional<std::uint8_t> find(Family family, std::string_view name) {
  for (const auto& row : list)
    if (row.name == name && (row.families & set_of(family)) != 0) return row.number;
  return std::nullopt;
}

}  // namespace numbered

consteval std::uint8_t number_of(Family family, std::string_view name) {
  const auto number = numbered::find(family, name);
  if (!number) throw std::invalid_argument("no such parameter of this family in the list");
  return *number;
}

/// For a name that has one number, whatever the family.
consteval std::uint8_t number_of(std::string_view name) {
  std::optional<std::uint8_t> found;
  for (const auto& row : numbered::list) {
    if (row.name != name) continue;
    if (found) throw std::invalid_argument("the number depends on the family");
    found = row.number;
  }
  if (!found) throw std::invalid_argument("no such parameter in the list");
  return *found;
}

}  // namespace tmcl

/// Axis parameters that only the simulator has to do with. Where a number means something else on a
/// family, its users say so.
#pragma once

#include <cstdint>

namespace tmcl::sim::number {

constexpr std::uint8_t max_current = 6;
constexpr std::uint8_t standby_current = 7;
constexpr std::uint8_t home_switch = 9;
constexpr std::uint8_t right_switch = 10;
constexpr std::uint8_t left_switch = 11;
constexpr std::uint8_t right_switch_disable = 12;
constexpr std::uint8_t left_switch_disable = 13;
constexpr std::uint8_t measured_speed = 29;
constexpr std::uint8_t tmc457_encoder_position = 41;
constexpr std::uint8_t end_switch_power_down = 150;
constexpr std::uint8_t stall_guard_threshold = 174;
constexpr std::uint8_t current_scale = 180;
constexpr std::uint8_t stop_on_stall = 181;
constexpr std::uint8_t search_mode = 193;
constexpr std::uint8_t search_speed = 194;
constexpr std::uint8_t switch_speed = 195;
constexpr std::uint8_t end_switch_distance = 196;
constexpr std::uint8_t last_reference = 197;
constexpr std::uint8_t latched_encoder = 199;
constexpr std::uint8_t boost_current = 200;
constexpr std::uint8_t freewheeling_delay = 204;
constexpr std::uint8_t load_value = 206;
constexpr std::uint8_t error_flags = 207;
constexpr std::uint8_t driver_flags = 208;
constexpr std::uint8_t encoder_position = 209;
constexpr std::uint8_t encoder_scale = 210;
constexpr std::uint8_t max_deviation = 212;
constexpr std::uint8_t group_index = 213;
constexpr std::uint8_t power_down_delay = 214;
constexpr std::uint8_t absolute_angle = 215;
constexpr std::uint8_t external_encoder_position = 216;
constexpr std::uint8_t external_encoder_scale = 217;
constexpr std::uint8_t external_max_deviation = 218;
constexpr std::uint8_t tmc4361_group_index = 249;
constexpr std::uint8_t reverse_shaft = 251;

}  // namespace tmcl::sim::number

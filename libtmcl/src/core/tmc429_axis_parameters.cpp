#include "core/common_axis_parameters.hpp"

namespace tmcl {
namespace {

using namespace row;

constexpr std::int32_t x_max = (1 << 23) - 1;  // 24-bit positions
constexpr std::int32_t x_min = -(1 << 23);
constexpr std::int32_t v_max = 2047;  // 11-bit speeds and a sign
constexpr Positions short_positions{x_min, x_max};
constexpr Speeds speed{v_max, "internal", Scale::fixed};

// With a TMC236, TMC246 or TMC249, which the motion controller writes itself.
constexpr auto old_driver = only({351, 610});
constexpr auto new_driver = ~old_driver;
constexpr auto tmcm351 = only({351});
constexpr auto counts_pulses = only({351, 1110, 1140, 1160, 3110});
constexpr auto has_encoder = counts_pulses | only({1161});

// Numbers from PyTrinamic's lists; ranges and meanings from the firmware manuals of the TMCM-6110
// and TMCM-351; what a module starts with from the open firmware of the TMCM-1110. No document at
// hand says what the speeds of a reference search start with: what is here finds a switch.
// clang-format off
constexpr auto tmc429_axis = std::to_array<ParameterRow>({
    {target_position(short_positions, {"X_TARGET", "x_target"})},
    {{1, "actual_position", {"x_actual", "position"}, rw, false, x_min, x_max, 0, "microstep",
      "where the motor is; set it only at standstill or in velocity mode", "X_ACTUAL"}},
    {{2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v_max, v_max, 0, "internal",
      "speed set-point in velocity mode; in position mode what the ramp asks for", "V_TARGET"}},
    {actual_velocity(speed, {"V_ACTUAL", "v_actual"})},
    {max_velocity(speed, 1000, {"V_MAX", "v_max"})},
    {{5, "max_acceleration", {"a_max", ""}, rw, true, 0, v_max, 500, "internal",
      "acceleration and deceleration of every ramp", "A_MAX"}},
    {run_current(255)},
    {standby_current(32)},
    {position_reached},
    {home_switch},
    {right_switch},
    {left_switch},
    {right_switch_disable},
    {left_switch_disable},
    {{130, "minimum_velocity", {"v_min", "minimum_speed"}, rw, true, 0, v_max, 1, "internal",
      "speed at which the end of a ramp may stop at once; with 0 it does not arrive", "V_MIN"}},
    {{135, "actual_acceleration", {"a_actual", ""}, r, false, -v_max, v_max, 0, "internal",
      "present acceleration", "A_ACTUAL"}},
    // No document at hand has the ranges of 137 and 146.
    {{136, "acceleration_threshold", {"a_threshold", ""}, rw, true, 0, v_max, 0, "internal",
      "acceleration from which on the current for accelerating is used", "A_THRESHOLD"}, only({610})},
    {{137, "acceleration_divisor", {"", ""}, rw, true, 0, 13, 0, "2^n",
      "scale of accelerations, as an exponent of two"}, only({610})},
    {{138, "ramp_mode", {"ramp_type", ""}, rw, true, 0, 2, 0, "",
      "0 position, 1 soft, 2 velocity; set by ROR, ROL, MST and MVP", "RM"}},
    {in_register(microstep_resolution, "USRS"), ~tmcm351},
    {{140, "microstep_resolution", {"usrs", ""}, rw, true, 0, 6, 6, "2^n",
      "microsteps of a full step, as an exponent of two", "USRS"}, tmcm351},
    {{141, "reference_switch_tolerance", {"ref_switch_tolerance", ""}, rw, false, 0, 4095, 0, "microstep",
      "how far a reference switch may be off before the chip counts that as an error; no command shows it", "DX_REF_TOLERANCE"}},
    {{142, "latched_position", {"snapshot_position", "x_latched"}, r, false, x_min, x_max, 0, "microstep",
      "where the motor was when the reference switch was met", "X_LATCHED"}, only({610})},
    {{146, "acceleration_factor", {"", ""}, rw, true, 0, 255, 0, "",
      "factor of the acceleration for the currents"}, only({610})},
    {{149, "soft_stop", {"soft_stop_flag", ""}, rw, true, 0, 1, 0, "flag",
      "at a limit switch the motor: 0 stops at once, 1 slows down", "REF_CONF"}},
    {{150, "end_switch_power_down", {"", ""}, rw, true, 0, 1, 0, "flag",
      "1: a limit switch that is met takes the current off the motor"}, new_driver},
    {{153, "ramp_divisor", {"ramp_div", ""}, rw, true, 0, 13, 3, "2^n",
      "scale of accelerations, as an exponent of two", "RAMP_DIV"}},
    {{154, "pulse_divisor", {"pulse_div", ""}, rw, true, 0, 13, 2, "2^n",
      "scale of speeds and accelerations, as an exponent of two", "PULSE_DIV"}},
    {step_interpolation, new_driver},
    {double_edge_steps, new_driver},
    {chopper_blank_time, new_driver},
    {constant_toff_mode, new_driver},
    {disable_fast_decay_comparator, new_driver},
    {chopper_hysteresis_end, new_driver},
    {chopper_hysteresis_start, new_driver},
    {toff, new_driver},
    {smart_energy_current_minimum, new_driver},
    {smart_energy_current_down_step, new_driver},
    {smart_energy_hysteresis, new_driver},
    {smart_energy_current_up_step, new_driver},
    {smart_energy_hysteresis_start, new_driver},
    {stallguard2_filter_enable, new_driver},
    {stallguard2_threshold, new_driver},
    {slope_control_high_side, new_driver},
    {slope_control_low_side, new_driver},
    {short_protection_disable, new_driver},
    {short_detection_time, new_driver},
    {vsense, new_driver},
    {smart_energy_actual_current, new_driver},
    {stall_velocity(speed), new_driver},
    {threshold_speed(speed), new_driver},
    {smart_energy_slow_run_current, new_driver},
    {random_toff_mode, new_driver},
    {reference_search_mode, ~tmcm351},
    {{193, "reference_search_mode", {"", ""}, rw, true, 1, 3, 1, "",
      "1 left switch, 2 right, then left, 3 right, then left from both sides"}, tmcm351},
    {search_speed(speed, 500)},
    {switch_speed(speed, 100)},
    {reference_switch_distance},
    {last_reference_position},
    {boost_current},
    {{201, "encoder_mode", {"", ""}, rw, true, 0, 65535, 0, "bits",
      "what the null channel of the encoder does; simulated ones have none"}, only({3110})},
    {{203, "mixed_decay_threshold", {"", ""}, rw, true, -1, 2048, 2048, "internal",
      "mixed decay above this speed; -1: always"}, old_driver},
    {{204, "freewheeling_delay", {"", ""}, rw, true, 0, 65535, 0, "10 ms",
      "how long after a stop the current goes off altogether; 0: never"}},
    {{205, "stall_threshold", {"stallguard_threshold", ""}, rw, true, 0, 7, 0, "",
      "load value that stops the motor; 0: none"}, old_driver},
    {load_value, new_driver},
    {{206, "load_value", {"", ""}, r, false, 0, 7, 0, "",
      "stallGuard: the smaller, the more load"}, old_driver},
    {extended_error_flags, ~tmcm351},
    {{207, "movement_error_flags", {"extended_error_flags", "error_flags"}, r, false, 0, 3, 0, "bits",
      "why the motor was stopped: 1 deviation of the encoder, 2 stall; the next movement clears them"}, tmcm351},
    {driver_status_flags},
    {encoder_position, has_encoder},
    {{210, "encoder_prescaler", {"", ""}, rw, true, 0, 65535, 0, "",
      "how the pulses of the encoder come to microsteps"}, counts_pulses},
    {{210, "encoder_resolution", {"", ""}, rw, true, 0, 65535, 0, "",
      "pulses of one turn of the encoder"}, only({1161})},
    {{211, "fullstep_threshold", {"", ""}, rw, true, 0, 2048, 0, "internal",
      "full steps above this speed; 0 and 2048: never"}, old_driver},
    {max_encoder_deviation, has_encoder},
    {group_index, only({351, 610, 1110, 3110, 6110})},
    {power_down_delay},
    {absolute_encoder_value, only({1140, 1160, 1161})},
    {external_encoder_position, only({1140, 1160})},
    {{217, "external_encoder_prescaler", {"", ""}, rw, true, 0, 65535, 0, "",
      "how the pulses of the external encoder come to microsteps"}, only({1140, 1160})},
    {external_encoder_max_deviation, only({1140, 1160})},
    {step_direction_mode, only({1110, 1160, 1161, 3110})},
});
// clang-format on

static_assert(is_sound(tmc429_axis, Family::tmc429));

}  // namespace

std::span<const ParameterRow> tmc429_axis_rows() { return tmc429_axis; }

}  // namespace tmcl

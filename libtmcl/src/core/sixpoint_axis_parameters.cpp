#include "core/common_axis_parameters.hpp"
#include "tmcl/units.hpp"

namespace tmcl {
namespace {

using namespace row;

// The greatest whole number of microsteps per second that a register holds.
constexpr std::int32_t in_pps(std::int64_t greatest, RegisterUnit unit) {
  return static_cast<std::int32_t>(greatest * unit.numerator / unit.denominator);
}

constexpr std::int32_t v_max = in_pps((1 << 23) - 512, sixpoint_velocity_unit);
constexpr Speeds speed{v_max, "pps", Scale::velocity};
constexpr std::int32_t v1_max = in_pps((1 << 20) - 1, sixpoint_velocity_unit);
constexpr std::int32_t v_edge_max = in_pps((1 << 18) - 1, sixpoint_velocity_unit);
constexpr std::int32_t a_max = in_pps((1 << 16) - 1, sixpoint_acceleration_unit);

// A TMC5240, with three stages of acceleration and stallGuard4.
constexpr auto tmc5240 = only({3216});
constexpr auto has_global_scaler = only({1210, 1211, 1240, 1241, 1260, 3216});
constexpr auto interpolates = only({1210, 1211, 1240, 1241, 1260, 3216});
constexpr auto stops_when_told = only({1276, 1278});
constexpr auto compares_positions = only({6214});

// Numbers from PyTrinamic's lists and from the vendor's ROS driver, ranges from the firmware manual
// of the TMCM-3212 and the data sheets of the TMC5130, TMC5160 and TMC5240, registers from the
// vendor's evaluation firmware, what a module starts with from the open firmware of the
// TMC5130-HBS-KIT. No document at hand says what the speeds of a reference search start with: what
// is here finds a switch.
// clang-format off
constexpr auto sixpoint_axis = std::to_array<ParameterRow>({
    {target_position(positions, {"XTARGET", "xtarget"})},
    {actual_position(positions, {"XACTUAL", "xactual"})},
    {turning_velocity(speed, "VMAX")},
    {actual_velocity(speed, {"VACTUAL", "vactual"})},
    {max_velocity(speed, 51200, {"VMAX", "vmax"})},
    {{5, "max_acceleration", {"amax", ""}, rw, true, 0, a_max, 51200, "pps/s",
      "acceleration above velocity V1, and every ramp of ROR, ROL and MST", "AMAX", Scale::acceleration}},
    {run_current(128, "IHOLD_IRUN.IRUN")},
    {standby_current(8, "IHOLD_IRUN.IHOLD")},
    {position_reached},
    {home_switch},
    {right_switch},
    {left_switch},
    {in_register(right_switch_disable, "SW_MODE.STOP_R_ENABLE"), ~stops_when_told},
    // Named so in PyTrinamic; the other way round than on other modules, as in the vendor's evaluation firmware. What
    // it starts with is in no document at hand.
    {{12, "automatic_right_stop", {"", ""}, rw, true, 0, 1, 1, "flag",
      "1: the right limit switch stops the motor", "SW_MODE.STOP_R_ENABLE"}, stops_when_told},
    {in_register(left_switch_disable, "SW_MODE.STOP_L_ENABLE"), ~stops_when_told},
    {{13, "automatic_left_stop", {"", ""}, rw, true, 0, 1, 1, "flag",
      "1: the left limit switch stops the motor", "SW_MODE.STOP_L_ENABLE"}, stops_when_told},
    {{14, "swap_limit_switches", {"swap_switch_inputs", "swap_lr"}, rw, true, 0, 1, 0, "flag",
      "1: the limit switches change places", "SW_MODE.SWAP_LR"}},
    {{15, "acceleration_a1", {"a1", ""}, rw, true, 0, a_max, 25600, "pps/s",
      "acceleration up to velocity V1", "A1", Scale::acceleration}},
    {{16, "velocity_v1", {"v1", ""}, rw, true, 0, v1_max, 25600, "pps",
      "where A1 ends and D1 begins; 0: neither is used", "V1", Scale::velocity}},
    {{17, "max_deceleration", {"dmax", "deceleration"}, rw, true, 0, a_max, 51200, "pps/s",
      "deceleration down to velocity V1", "DMAX", Scale::acceleration}},
    {{18, "deceleration_d1", {"d1", ""}, rw, true, 0, a_max, 25600, "pps/s",
      "deceleration below velocity V1; never 0 when positioning", "D1", Scale::acceleration}},
    {{19, "start_velocity", {"vstart", ""}, rw, true, 0, v_edge_max, 1, "pps",
      "speed a ramp begins with", "VSTART", Scale::velocity}},
    {{20, "stop_velocity", {"vstop", ""}, rw, true, 0, v_edge_max, 10, "pps",
      "speed a ramp may stop from; 10 at least, and no less than the start velocity", "VSTOP", Scale::velocity}},
    {{21, "ramp_wait_time", {"tzerowait", ""}, rw, true, 0, 65535, 0, "32 us",
      "standstill after a ramp, before the motor turns round or moves again", "TZEROWAIT"}},
    {{22, "high_speed_threshold", {"thigh", ""}, rw, true, 0, v_max, 0, "pps",
      "above this speed the high speed modes (27, 28) are used; 0: never", "THIGH", Scale::velocity}},
    {{23, "min_dcstep_speed", {"vdcmin", ""}, rw, true, 0, v_max, 0, "pps",
      "above this speed dcStep is used; 0: never", "VDCMIN", Scale::velocity}},
    {{24, "right_limit_switch_polarity", {"right_switch_polarity", "pol_stop_r"}, rw, true, 0, 1, 0, "flag",
      "1: the right limit switch is met when its input is low", "SW_MODE.POL_STOP_R"}},
    {{25, "left_limit_switch_polarity", {"left_switch_polarity", "pol_stop_l"}, rw, true, 0, 1, 0, "flag",
      "1: the left limit switch is met when its input is low", "SW_MODE.POL_STOP_L"}},
    {{26, "soft_stop", {"en_softstop", ""}, rw, true, 0, 1, 0, "flag",
      "at a limit switch the motor: 0 stops at once, 1 slows down", "SW_MODE.EN_SOFTSTOP"}},
    {{27, "high_speed_chopper_mode", {"vhighchm", ""}, rw, true, 0, 1, 0, "flag",
      "1: constant off time above the high speed threshold", "CHOPCONF.VHIGHCHM"}},
    {{28, "high_speed_fullstep_mode", {"vhighfs", ""}, rw, true, 0, 1, 0, "flag",
      "1: full steps above the high speed threshold", "CHOPCONF.VHIGHFS"}},
    {{29, "measured_speed", {"", ""}, r, false, -v_max, v_max, 0, "pps",
      "speed that the encoder has measured", "", Scale::velocity}},
    {{31, "power_down_ramp", {"iholddelay", ""}, rw, true, 0, 15, 7, "0.016 s",
      "how slowly the current goes down to the standby current", "IHOLD_IRUN.IHOLDDELAY"}},
    {{32, "dcstep_time", {"dc_time", ""}, rw, true, 0, 1023, 0, "clock",
      "dcStep: how long a step may take before it is repeated", "DCCTRL.DC_TIME"}},
    {{33, "dcstep_stallguard", {"dc_sg", ""}, rw, true, 0, 255, 0, "16 clock",
      "dcStep: how short a step counts as a stall; 0: none does", "DCCTRL.DC_SG"}},
    {{34, "acceleration_a2", {"a2", ""}, rw, true, 0, a_max, 0, "pps/s",
      "acceleration between the velocities V1 and V2", "A2", Scale::acceleration}, tmc5240},
    {{35, "velocity_v2", {"v2", ""}, rw, true, 0, v1_max, 0, "pps",
      "where A2 ends and D2 begins; 0: neither is used", "V2", Scale::velocity}, tmc5240},
    {{36, "deceleration_d2", {"d2", ""}, rw, true, 0, a_max, 0, "pps/s",
      "deceleration between the velocities V2 and V1", "D2", Scale::acceleration}, tmc5240},
    {{37, "max_velocity_minimum_time", {"vmax_minium_time", "tvmax"}, rw, true, 0, 65535, 0, "32 us",
      "how long a ramp stays at its greatest speed at least", "TVMAX"}, tmc5240},
    {{38, "virtual_stop_left", {"", ""}, rw, true, x_least, x_greatest, 0, "microstep",
      "left limit of positions", "VIRTUAL_STOP_L"}, tmc5240},
    {{39, "virtual_stop_right", {"", ""}, rw, true, x_least, x_greatest, 0, "microstep",
      "right limit of positions", "VIRTUAL_STOP_R"}, tmc5240},
    {{40, "virtual_stop_flags", {"", ""}, r, false, 0, 3, 0, "bits",
      "virtual stops that are met: 1 left, 2 right", "RAMP_STAT"}, tmc5240},
    {{40, "position_compare_start", {"", ""}, rw, true, x_least, x_greatest, 0, "microstep",
      "position of the first pulse"}, compares_positions},
    {{41, "virtual_stop_enable", {"", ""}, rw, true, 0, 3, 0, "bits",
      "virtual stops that stop the motor: 1 left, 2 right", "SW_MODE.EN_VIRTUAL_STOP_L"}, tmc5240},
    {{41, "position_compare_distance", {"", ""}, rw, true, x_least, x_greatest, 0, "microstep",
      "distance from one pulse to the next"}, compares_positions},
    {{42, "virtual_stop_encoder_mode", {"", ""}, rw, true, 0, 1, 0, "",
      "virtual stops are compared with: 0 the position, 1 the encoder", "SW_MODE.VIRTUAL_STOP_ENC"}, tmc5240},
    // No document at hand has the ranges of 42, 43 and 240.
    {{42, "position_compare_output", {"", ""}, rw, true, 0, 255, 0, "",
      "which output gives the pulses; 0: none"}, compares_positions},
    {{43, "position_compare_position", {"pos_comp_position", "x_compare"}, rw, true, x_least, x_greatest, 0, "microstep",
      "position of the first pulse", "X_COMPARE"}, tmc5240},
    {{43, "position_compare_pulse_length", {"position_compare_output_pulse_length", ""}, rw, true, 0, x_greatest, 0, "",
      "how long a pulse is"}, compares_positions},
    {{44, "position_compare_repeat", {"pos_comp_repeat", "x_compare_repeat"}, rw, true, 0, (1 << 24) - 1, 0, "microstep",
      "distance from one pulse to the next; 0: one pulse only", "X_COMPARE_REPEAT"}, tmc5240},
    {{45, "position_compare_output_mask", {"pos_comp_output_mask", ""}, rw, true, 0, 255, 0, "bits",
      "which outputs give the pulses"}, tmc5240},
    {{46, "position_compare_pulse_length", {"pos_comp_pulse_length", ""}, rw, true, 0, x_greatest, 0, "",
      "how long a pulse is"}, tmc5240},
    {{47, "target_reached_output_mask", {"", ""}, rw, true, 0, 255, 0, "bits",
      "which outputs say that the target is reached"}, tmc5240},
    {{48, "motion_start_input_mask", {"", ""}, rw, true, 0, 255, 0, "bits",
      "which inputs let a movement begin"}, tmc5240},
    {relative_positioning_option},
    {microstep_resolution},
    {in_register(step_interpolation, "CHOPCONF.INTPOL"), interpolates},
    {in_register(double_edge_steps, "CHOPCONF.DEDGE"), interpolates & ~tmc5240},
    {chopper_blank_time},
    {constant_toff_mode},
    {in_register(disable_fast_decay_comparator, "CHOPCONF.DISFDCC")},
    {starting_with(chopper_hysteresis_end, -2)},
    {chopper_hysteresis_start},
    {starting_with(toff, 3)},
    {in_register(smart_energy_current_minimum, "COOLCONF.SEIMIN")},
    {in_register(smart_energy_current_down_step, "COOLCONF.SEDN")},
    {in_register(smart_energy_hysteresis, "COOLCONF.SEMAX")},
    {in_register(smart_energy_current_up_step, "COOLCONF.SEUP")},
    {in_register(smart_energy_hysteresis_start, "COOLCONF.SEMIN")},
    {in_register(stallguard2_filter_enable, "COOLCONF.SFILT")},
    {in_register(stallguard2_threshold, "COOLCONF.SGT")},
    {in_register(short_protection_disable, "CHOPCONF.DISS2G"), only({1270, 1276, 1278, 6212, 6214})},
    {{178, "global_current_scaler", {"globalscaler", ""}, rw, true, 0, 255, 0, "1/256",
      "scale of all currents, 32 at least; 0: full", "GLOBAL_SCALER"}, has_global_scaler},
    {in_register(vsense, "CHOPCONF.VSENSE"), only({1270, 6212, 6214})},
    {{179, "full_scale_current_range", {"current_range", ""}, rw, true, 0, 3, 0, "code",
      "greatest current: 0 1 A, 1 2 A, 2 and 3 3 A", "DRV_CONF.CURRENT_RANGE"}, tmc5240},
    {in_register(smart_energy_actual_current, "DRV_STATUS.CS_ACTUAL")},
    {stall_velocity(speed, "TCOOLTHRS")},
    {threshold_speed(speed, "TCOOLTHRS")},
    {random_toff_mode, ~tmc5240},
    {chopper_synchronization, ~tmc5240},
    {{185, "passive_fast_decay_time", {"tpfd", ""}, rw, true, 0, 15, 4, "128 clock",
      "spreadCycle: passive fast decay against resonances in mid range", "CHOPCONF.TPFD"}, tmc5240},
    {pwm_threshold_speed(speed)},
    {pwm_gradient},
    {pwm_amplitude},
    {pwm_scale},
    {pwm_mode},
    {pwm_frequency},
    {pwm_autoscale},
    {reference_search_mode},
    {search_speed(speed, 25600)},
    {switch_speed(speed, 5120)},
    {reference_switch_distance},
    {last_reference_position},
    {latched_position({"XLATCH", "xlatch"}), only({1210, 1211, 6212, 6214})},
    {latched_encoder_position, only({1210, 1211, 6212, 6214})},
    {{201, "encoder_mode", {"encmode", ""}, rw, true, 0, 65535, 0, "bits",
      "what the null channel of the encoder does; simulated ones have none", "ENCMODE"}, except({1240, 1241, 1260})},
    {full_step_resolution},
    {{203, "pwm_symmetric", {"", ""}, rw, true, 0, 1, 0, "flag",
      "stealthChop: 1: symmetric pulses", "PWMCONF.PWM_SYMMETRIC"}, only({1270, 1276, 1278})},
    {freewheeling_mode},
    {in_register(load_value, "DRV_STATUS.SG_RESULT")},
    {extended_error_flags},
    {in_register(also_called(driver_status_flags, "status_flags"), "DRV_STATUS")},
    {in_register(encoder_position, "X_ENC")},
    {{210, "encoder_resolution", {"enc_const", ""}, rw, true, x_least, x_greatest, 0, "",
      "pulses of one turn of the encoder; negative: it counts the other way", "ENC_CONST"},
     only({1210, 1211, 1270, 1276, 1278, 3216, 6214})},
    {{210, "encoder_clear_on_null", {"clr_cont", ""}, rw, true, 0, 1, 0, "flag",
      "1: the null channel of the encoder sets its position to 0", "ENCMODE.CLR_CONT"}, only({1240, 1241, 1260, 6212})},
    {max_encoder_deviation},
    {group_index, only({6212, 6214})},
    {{214, "power_down_delay", {"tpowerdown", "setting_delay"}, rw, true, 0, 417, 200, "10 ms",
      "how long after a stop the standby current takes over", "TPOWERDOWN"}},
    {absolute_encoder_value, only({1240, 1241, 1260})},
    {external_encoder_position, only({1240, 1241, 1260})},
    {{217, "external_encoder_resolution", {"", ""}, rw, true, x_least, x_greatest, 0, "",
      "pulses of one turn of the external encoder; negative: it counts the other way"}, only({1240, 1241, 1260})},
    {external_encoder_max_deviation, only({1240, 1241, 1260})},
    {{220, "stallguard4_result", {"sg4_result", ""}, r, false, 0, 1023, 0, "",
      "load in stealthChop: the smaller, the more", "SG4_RESULT"}, tmc5240},
    {{221, "stallguard4_threshold", {"sg4_thrs", ""}, rw, true, 0, 255, 0, "",
      "load value in stealthChop that is a stall", "SG4_THRS"}, tmc5240},
    {{222, "stallguard4_filter_enable", {"sg4_filt_en", ""}, rw, true, 0, 1, 0, "flag",
      "1: the load value is the mean over four full steps", "SG4_THRS.SG4_FILT_EN"}, tmc5240},
    {{223, "stallguard4_angle_offset", {"sg_angle_offset", ""}, rw, true, 0, 1, 0, "flag",
      "1: no jerk where stealthChop and spreadCycle change over", "SG4_THRS.SG_ANGLE_OFFSET"}, tmc5240},
    {{240, "deviation_action", {"", ""}, rw, true, 0, 255, 0, "",
      "what happens where encoder and position differ by too much"}, only({6214})},
    {reverse_shaft, except({1270, 1276})},
    {step_direction_mode, only({1240, 1241, 1260})},
    {{255, "unit_mode", {"", ""}, rw, true, 0, 1, 1, "",
      "velocities and accelerations: 0 units of the chip, 1 microsteps per second"}, ~tmc5240},
});
// clang-format on

static_assert(is_sound(sixpoint_axis, Family::sixpoint));

}  // namespace

std::span<const ParameterRow> sixpoint_axis_rows() { return sixpoint_axis; }

}  // namespace tmcl

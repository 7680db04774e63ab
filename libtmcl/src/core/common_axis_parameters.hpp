/// Axis parameters that are the same in several families.
#pragma once

#include "core/parameter_row.hpp"

namespace tmcl::row {

/// The same parameter where a chip has another register for it.
constexpr ParameterInfo in_register(ParameterInfo info, std::string_view chip_register) {
  info.chip_register = chip_register;
  return info;
}

/// The same parameter where the factory default is another one.
constexpr ParameterInfo starting_with(ParameterInfo info, std::int32_t initial) {
  info.initial = initial;
  return info;
}

/// The same parameter where its second alias is another one.
constexpr ParameterInfo also_called(ParameterInfo info, std::string_view alias) {
  info.aliases[1] = alias;
  return info;
}

/// The same parameter where it has another number.
constexpr ParameterInfo with_number(std::uint8_t number, ParameterInfo info) {
  info.number = number;
  return info;
}

/// A register of the chip, and how it is called as an alias.
struct Place {
  std::string_view chip_register = {};
  std::string_view alias = {};
};

struct Positions {
  std::int32_t least;
  std::int32_t greatest;
};
inline constexpr Positions positions{x_least, x_greatest};

/// Speeds of a family: they go so far in both directions.
struct Speeds {
  std::int32_t greatest;
  std::string_view unit;
  Scale scale;
};

// clang-format off
constexpr ParameterInfo target_position(Positions range, Place place = {}) {
  return {0, "target_position", {place.alias, ""}, rw, false, range.least, range.greatest, 0, "microstep",
          "where the motor goes; writing it in position mode starts a ramp", place.chip_register};
}
constexpr ParameterInfo actual_position(Positions range, Place place = {}) {
  return {1, "actual_position", {place.alias, "position"}, rw, false, range.least, range.greatest, 0, "microstep",
          "where the motor is; in position mode it drives to its target after that", place.chip_register};
}
constexpr ParameterInfo turning_velocity(Speeds speed, std::string_view chip_register = {}) {
  return {2, "target_velocity", {"", "target_speed"}, rw, false, -speed.greatest, speed.greatest, 0, speed.unit,
          "writing it makes the motor turn, as ROR and ROL do; reads the speed that the ramp goes up to",
          chip_register, speed.scale};
}
constexpr ParameterInfo actual_velocity(Speeds speed, Place place = {}) {
  return {3, "actual_velocity", {place.alias, "actual_speed"}, r, false, -speed.greatest, speed.greatest, 0, speed.unit,
          "present speed", place.chip_register, speed.scale};
}
constexpr ParameterInfo max_velocity(Speeds speed, std::int32_t initial, Place place = {}) {
  return {4, "max_velocity", {place.alias, "max_positioning_speed"}, rw, true, 0, speed.greatest, initial, speed.unit,
          "greatest speed of a positioning move", place.chip_register, speed.scale};
}
constexpr ParameterInfo run_current(std::int32_t initial, std::string_view chip_register = {}) {
  return {6, "max_current", {"run_current", ""}, rw, true, 0, 255, initial, "1/255",
          "current while moving, as a part of the module's greatest; effective in steps of 8", chip_register};
}
constexpr ParameterInfo standby_current(std::int32_t initial, std::string_view chip_register = {}) {
  return {7, "standby_current", {"", ""}, rw, true, 0, 255, initial, "1/255",
          "current at standstill", chip_register};
}
constexpr ParameterInfo stall_velocity(Speeds speed, std::string_view chip_register = {}) {
  return {181, "smart_energy_stall_velocity", {"stop_on_stall_velocity", ""}, rw, true, 0, speed.greatest, 0,
          speed.unit, "above this speed a stall stops the motor; 0: never", chip_register, speed.scale};
}
constexpr ParameterInfo threshold_speed(Speeds speed, std::string_view chip_register = {}) {
  return {182, "smart_energy_threshold_speed", {"", ""}, rw, true, 0, speed.greatest, 0, speed.unit,
          "above this speed coolStep works", chip_register, speed.scale};
}
constexpr ParameterInfo pwm_threshold_speed(Speeds speed) {
  return {186, "pwm_threshold_speed", {"tpwmthrs", ""}, rw, true, 0, speed.greatest, 0, speed.unit,
          "stealthChop up to this speed; 0: at all speeds", "TPWMTHRS", speed.scale};
}
constexpr ParameterInfo search_speed(Speeds speed, std::int32_t initial) {
  return {194, "reference_search_speed", {"", ""}, rw, true, 0, speed.greatest, initial, speed.unit,
          "speed at which a reference search looks for a switch", "", speed.scale};
}
constexpr ParameterInfo switch_speed(Speeds speed, std::int32_t initial, std::string_view alias = "ref_switch_speed") {
  return {195, "reference_switch_speed", {alias, ""}, rw, true, 0, speed.greatest, initial, speed.unit,
          "speed at which a reference search finds the exact point of the switch", "", speed.scale};
}
constexpr ParameterInfo latched_position(Place place) {
  return {198, "latched_actual_position", {place.alias, ""}, r, false, x_least, x_greatest, 0, "microstep",
          "position when the null channel of the encoder or a switch was met", place.chip_register};
}
inline constexpr ParameterInfo latched_encoder_position{
    199, "latched_encoder_position", {"enc_latch", ""}, r, false, x_least, x_greatest, 0, "microstep",
    "what the encoder read when its null channel was met", "ENC_LATCH"};

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
    12, "right_limit_switch_disable", {"right_limit", ""}, rw, true, 0, 1, 0, "flag",
    "1: the right limit switch does not stop"};
inline constexpr ParameterInfo left_switch_disable{
    13, "left_limit_switch_disable", {"left_limit", ""}, rw, true, 0, 1, 0, "flag",
    "1: the left limit switch does not stop"};
inline constexpr ParameterInfo relative_positioning_option{
    127, "relative_positioning_option", {"relative_positioning_option_code", ""}, rw, false, 0, 1, 0, "",
    "what MVP REL counts from: 0 the target position, 1 the actual position"};
inline constexpr ParameterInfo microstep_resolution{
    140, "microstep_resolution", {"usrs", ""}, rw, true, 0, 8, 8, "2^n",
    "microsteps of a full step, as an exponent of two", "CHOPCONF.MRES"};

// The motor driver: registers and start values of a TMC262 or its relatives, from the example of that data sheet. The
// drivers with motion controller inside have the same fields, most of them in registers of the same name.
inline constexpr ParameterInfo step_interpolation{
    160, "step_interpolation", {"intpol", "step_interpolation_enable"}, rw, true, 0, 1, 0, "flag",
    "1: the driver makes 256 microsteps of each step of a 1/16 resolution", "DRVCTRL.INTPOL"};
inline constexpr ParameterInfo double_edge_steps{
    161, "double_edge_steps", {"dedge", ""}, rw, true, 0, 1, 0, "flag",
    "1: both edges of a step pulse count", "DRVCTRL.DEDGE"};
inline constexpr ParameterInfo chopper_blank_time{
    162, "chopper_blank_time", {"tbl", ""}, rw, true, 0, 3, 2, "code",
    "how long the comparator looks away after a switching: 0 16, 1 24, 2 36, 3 54 clock cycles", "CHOPCONF.TBL"};
inline constexpr ParameterInfo constant_toff_mode{
    163, "constant_toff_mode", {"chm", "chopper_mode"}, rw, true, 0, 1, 0, "",
    "chopper: 0 spreadCycle, 1 with constant off time", "CHOPCONF.CHM"};
inline constexpr ParameterInfo disable_fast_decay_comparator{
    164, "disable_fast_decay_comparator", {"disfdcc", ""}, rw, true, 0, 1, 0, "flag",
    "constant off time: 1: fast decay ends by time alone", "CHOPCONF.HDEC"};
inline constexpr ParameterInfo chopper_hysteresis_decrement{
    164, "chopper_hysteresis_decrement", {"hdec", ""}, rw, true, 0, 3, 0, "code",
    "how fast the hysteresis falls", "CHOPCONF.HDEC"};
inline constexpr ParameterInfo chopper_hysteresis_end{
    165, "chopper_hysteresis_end", {"hend", ""}, rw, true, -3, 12, 0, "",
    "spreadCycle: where the hysteresis ends; constant off time: offset of the sine wave", "CHOPCONF.HEND"};
inline constexpr ParameterInfo chopper_hysteresis_start{
    166, "chopper_hysteresis_start", {"hstrt", ""}, rw, true, 0, 8, 4, "",
    "spreadCycle: what the hysteresis starts above its end; constant off time: fast decay time", "CHOPCONF.HSTRT"};
inline constexpr ParameterInfo toff{
    167, "toff", {"chopper_off_time", ""}, rw, true, 0, 15, 4, "",
    "off time of the chopper; 0: the driver is off, the motor is free", "CHOPCONF.TOFF"};
inline constexpr ParameterInfo smart_energy_current_minimum{
    168, "smart_energy_current_minimum", {"seimin", ""}, rw, true, 0, 1, 0, "",
    "coolStep goes down to: 0 a half, 1 a quarter of the current", "SMARTEN.SEIMIN"};
inline constexpr ParameterInfo smart_energy_current_down_step{
    169, "smart_energy_current_down_step", {"secds", "sedn"}, rw, true, 0, 3, 0, "code",
    "coolStep goes down by one after so many readings: 0 32, 1 8, 2 2, 3 1", "SMARTEN.SEDN"};
inline constexpr ParameterInfo smart_energy_hysteresis{
    170, "smart_energy_hysteresis", {"semax", ""}, rw, true, 0, 15, 0, "32",
    "coolStep: distance between the upper and the lower threshold of the load value", "SMARTEN.SEMAX"};
inline constexpr ParameterInfo smart_energy_current_up_step{
    171, "smart_energy_current_up_step", {"secus", "seup"}, rw, true, 0, 3, 0, "code",
    "coolStep goes up at each reading by: 0 1, 1 2, 2 4, 3 8", "SMARTEN.SEUP"};
inline constexpr ParameterInfo smart_energy_hysteresis_start{
    172, "smart_energy_hysteresis_start", {"semin", ""}, rw, true, 0, 15, 0, "32",
    "coolStep: lower threshold of the load value; 0: no coolStep", "SMARTEN.SEMIN"};
inline constexpr ParameterInfo stallguard2_filter_enable{
    173, "stallguard2_filter_enable", {"sg2_filter_enable", "sfilt"}, rw, true, 0, 1, 0, "flag",
    "1: the load value is the mean over four full steps; simulated loads show no difference", "SGCSCONF.SFILT"};
inline constexpr ParameterInfo stallguard2_threshold{
    174, "stallguard2_threshold", {"sg2_threshold", "sgt"}, rw, true, -64, 63, 0, "",
    "the higher, the more load it takes until the load value is 0", "SGCSCONF.SGT"};
inline constexpr ParameterInfo slope_control_high_side{
    175, "slope_control_high_side", {"slph", ""}, rw, true, 0, 3, 0, "code",
    "how steeply the upper transistors switch", "DRVCONF.SLPH"};
inline constexpr ParameterInfo slope_control_low_side{
    176, "slope_control_low_side", {"slpl", ""}, rw, true, 0, 3, 0, "code",
    "how steeply the lower transistors switch", "DRVCONF.SLPL"};
inline constexpr ParameterInfo short_protection_disable{
    177, "short_protection_disable", {"short_to_ground_protection", "diss2g"}, rw, true, 0, 1, 0, "flag",
    "1: a short circuit to ground does not switch the driver off", "DRVCONF.DISS2G"};
inline constexpr ParameterInfo short_detection_time{
    178, "short_detection_time", {"ts2g", ""}, rw, true, 0, 3, 0, "code",
    "after: 0 3.2, 1 1.6, 2 1.2, 3 0.8 microseconds of short circuit it switches off", "DRVCONF.TS2G"};
inline constexpr ParameterInfo vsense{
    179, "vsense", {"", ""}, rw, true, 0, 1, 0, "",
    "voltage over the sense resistors at full current: 0 high, 1 low", "DRVCONF.VSENSE"};
inline constexpr ParameterInfo smart_energy_actual_current{
    180, "smart_energy_actual_current", {"cs_actual", "se"}, r, false, 0, 31, 0, "1/32",
    "current that coolStep has set", "DRVSTATUS.SE"};
inline constexpr ParameterInfo smart_energy_slow_run_current{
    183, "smart_energy_slow_run_current", {"", ""}, rw, true, 0, 255, 0, "1/255",
    "current below the threshold speed of coolStep"};
inline constexpr ParameterInfo random_toff_mode{
    184, "random_toff_mode", {"rndtf", ""}, rw, true, 0, 1, 0, "flag",
    "1: the off time of the chopper varies at random", "CHOPCONF.RNDTF"};
inline constexpr ParameterInfo chopper_synchronization{
    185, "chopper_synchronization", {"sync", ""}, rw, true, 0, 15, 0, "",
    "synchronizes the choppers of both coils; 0: not", "CHOPCONF.SYNC"};
inline constexpr ParameterInfo pwm_gradient{
    187, "pwm_gradient", {"pwm_grad", ""}, rw, true, 0, 255, 4, "",
    "stealthChop: how the amplitude rises with the speed; with autoscale, 1 to 15: how fast it is adapted",
    "PWMCONF.PWM_GRAD"};
inline constexpr ParameterInfo pwm_amplitude{
    188, "pwm_amplitude", {"pwm_ampl", ""}, rw, true, 0, 255, 128, "",
    "stealthChop: amplitude at standstill; with autoscale its greatest", "PWMCONF.PWM_AMPL"};
inline constexpr ParameterInfo pwm_scale{
    189, "pwm_scale", {"", ""}, r, false, 0, 255, 0, "", "stealthChop: present amplitude", "PWM_SCALE"};
inline constexpr ParameterInfo pwm_mode{
    190, "pwm_mode", {"en_pwm_mode", ""}, rw, true, 0, 1, 0, "", "chopper: 0 spreadCycle, 1 stealthChop",
    "GCONF.EN_PWM_MODE"};
inline constexpr ParameterInfo pwm_frequency{
    191, "pwm_frequency", {"pwm_freq", ""}, rw, true, 0, 3, 1, "code",
    "stealthChop: clock frequency by 0 512, 1 341, 2 256, 3 205", "PWMCONF.PWM_FREQ"};
inline constexpr ParameterInfo pwm_autoscale{
    192, "pwm_autoscale", {"", ""}, rw, true, 0, 1, 1, "flag",
    "stealthChop: 1: the amplitude follows the current", "PWMCONF.PWM_AUTOSCALE"};

// Modes 1 to 4 plus 64 look for the other side first, 5 to 8 plus 128 take the home switch the other way round.
inline constexpr ParameterInfo reference_search_mode{
    193, "reference_search_mode", {"", ""}, rw, true, 1, 136, 1, "",
    "1 left switch, 2 right, then left, 3 right, then left from both sides, 4 left from both sides, 5 home negative, "
    "6 home positive (both turn round at a limit switch), 7 home positive, 8 home negative without limit switches"};
inline constexpr ParameterInfo reference_switch_distance{
    196, "reference_switch_distance", {"end_switch_distance", "right_limit_switch_position"}, r, false, 0, x_greatest, 0,
    "microstep", "distance of the limit switches that reference search modes 2 and 3 have found"};
inline constexpr ParameterInfo last_reference_position{
    197, "last_reference_position", {"last_reference_switch_position", ""}, r, false, x_least, x_greatest, 0,
    "microstep", "position of the switch before the last reference search set it to zero"};
inline constexpr ParameterInfo boost_current{
    200, "boost_current", {"", ""}, rw, true, 0, 255, 0, "1/255",
    "current while accelerating and slowing down; 0: as while moving"};
inline constexpr ParameterInfo full_step_resolution{
    202, "full_step_resolution", {"fullstep_resolution", "motor_full_step_resolution"}, rw, true, 0, 65535, 200,
    "full step", "full steps of one turn of the motor"};
inline constexpr ParameterInfo freewheeling_mode{
    204, "freewheeling_mode", {"freewheeling", ""}, rw, true, 0, 3, 0, "",
    "at standstill, with a standby current of 0: 0 normal, 1 free, 2 both coils shorted low, 3 shorted high",
    "PWMCONF.FREEWHEEL"};
inline constexpr ParameterInfo load_value{
    206, "load_value", {"sg_result", "stallguard2_value"}, r, false, 0, 1023, 0, "",
    "stallGuard2: the smaller, the more load; 0 is a stall", "DRVSTATUS.SG"};
inline constexpr ParameterInfo extended_error_flags{
    207, "extended_error_flags", {"error_flags", ""}, r, false, 0, 3, 0, "bits",
    "why the motor was stopped: 1 stall, 2 deviation of the encoder; reading clears them"};
inline constexpr ParameterInfo driver_status_flags{
    208, "driver_status_flags", {"drv_status_flags", "driver_error_flags"}, r, false, 0, 255, 0, "bits",
    "1 stall, 2 too hot, 4 nearly too hot, 8 short of coil A, 16 of coil B, 32 coil A open, 64 coil B open, "
    "128 standstill", "DRVSTATUS"};
inline constexpr ParameterInfo encoder_position{
    209, "encoder_position", {"x_enc", ""}, rw, false, x_least, x_greatest, 0, "microstep", "what the encoder reads"};
inline constexpr ParameterInfo max_encoder_deviation{
    212, "max_encoder_deviation", {"max_position_encoder_deviation", "encoder_deviation_max"}, rw, true, 0, 65535, 0,
    "microstep", "the motor stops where encoder and position differ by more; 0: never"};
inline constexpr ParameterInfo group_index{
    213, "group_index", {"", ""}, rw, false, 0, 255, 0, "",
    "an MVP of one motor moves all that have the same index; 0: it alone"};
inline constexpr ParameterInfo power_down_delay{
    214, "power_down_delay", {"setting_delay", ""}, rw, true, 1, 65535, 200, "10 ms",
    "how long after a stop the standby current takes over"};
// No document at hand has the width of the encoder's word; that of the sensOstep has 10 bit.
inline constexpr ParameterInfo absolute_encoder_value{
    215, "absolute_encoder_value", {"absolute_resolver_value", "absolute_encoder"}, r, false, 0, 65535, 0, "",
    "angle of the motor shaft that the internal encoder reads"};
inline constexpr ParameterInfo external_encoder_position{
    216, "external_encoder_position", {"", ""}, rw, false, x_least, x_greatest, 0, "microstep",
    "what the external encoder reads"};
inline constexpr ParameterInfo external_encoder_max_deviation{
    218, "external_encoder_max_deviation", {"", ""}, rw, true, 0, 65535, 0, "microstep",
    "the motor stops where external encoder and position differ by more; 0: never"};
inline constexpr ParameterInfo reverse_shaft{
    251, "reverse_shaft", {"shaft", ""}, rw, true, 0, 1, 0, "flag", "1: the motor turns the other way", "GCONF.SHAFT"};
inline constexpr ParameterInfo step_direction_mode{
    254, "step_direction_mode", {"step_dir_mode", ""}, rw, true, 0, 5, 0, "",
    "0: the motor follows commands; others: the step and direction inputs, with or without an enable input"};
// clang-format on

}  // namespace tmcl::row

#include "tmcl/parameter.hpp"

#include <algorithm>
#include <limits>

#include "core/text.hpp"
#include "tmcl/units.hpp"

namespace tmcl {
namespace {

constexpr auto r = Access::read;
constexpr auto rw = Access::read_write;
constexpr std::int32_t x_max = (1 << 23) - 1;  // 24-bit positions
constexpr std::int32_t x_min = -(1 << 23);
constexpr std::int32_t v_max = 2047;  // 11-bit speeds and a sign
constexpr std::int32_t x_least = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t x_greatest = std::numeric_limits<std::int32_t>::max();

constexpr std::uint8_t pulse_divisor = 154;
constexpr std::uint8_t unit_mode = 255;

// The greatest whole number of microsteps per second that a register holds.
constexpr std::int32_t in_pps(std::int64_t greatest, RegisterUnit unit) {
  return static_cast<std::int32_t>(greatest * unit.numerator / unit.denominator);
}

// clang-format off
// The same on every family.
constexpr ParameterInfo position_reached{
    8, "position_reached", {"position_reached_flag", ""}, r, false, 0, 1, 0, "flag",
    "1 while the actual position equals the target"};
constexpr ParameterInfo home_switch{
    9, "home_switch", {"reference_switch_status", ""}, r, false, 0, 1, 0, "flag",
    "state of the home switch"};
constexpr ParameterInfo right_switch{
    10, "right_limit_switch", {"right_endstop", ""}, r, false, 0, 1, 0, "flag",
    "state of the right limit switch"};
constexpr ParameterInfo left_switch{
    11, "left_limit_switch", {"left_endstop", ""}, r, false, 0, 1, 0, "flag",
    "state of the left limit switch"};
constexpr ParameterInfo right_switch_disable{
    12, "right_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag",
    "1: the right limit switch does not stop"};
constexpr ParameterInfo left_switch_disable{
    13, "left_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag",
    "1: the left limit switch does not stop"};
constexpr ParameterInfo microstep_resolution{
    140, "microstep_resolution", {"usrs", ""}, rw, true, 0, 8, 8, "2^n",
    "microsteps of a full step, as an exponent of two"};

// Ranges and meanings from the firmware manuals of the TMCM-6110 and TMCM-351; what a module starts with from the
// open firmware of the TMCM-1110.
constexpr auto tmc429_axis = std::to_array<ParameterInfo>({
    {0, "target_position", {"x_target", ""}, rw, false, x_min, x_max, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"},
    {1, "actual_position", {"x_actual", "position"}, rw, false, x_min, x_max, 0, "microstep",
     "where the motor is; set it only at standstill or in velocity mode"},
    {2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v_max, v_max, 0, "internal",
     "speed set-point in velocity mode; in position mode what the ramp asks for"},
    {3, "actual_velocity", {"v_actual", "actual_speed"}, r, false, -v_max, v_max, 0, "internal", "present speed"},
    {4, "max_velocity", {"v_max", "max_positioning_speed"}, rw, true, 0, v_max, 1000, "internal",
     "greatest speed of a positioning move"},
    {5, "max_acceleration", {"a_max", ""}, rw, true, 0, v_max, 500, "internal",
     "acceleration and deceleration of every ramp"},
    {6, "max_current", {"run_current", ""}, rw, true, 0, 255, 255, "1/255",
     "current while moving, as a part of the module's greatest; effective in steps of 8"},
    {7, "standby_current", {"", ""}, rw, true, 0, 255, 32, "1/255", "current at standstill"},
    position_reached, home_switch, right_switch, left_switch, right_switch_disable, left_switch_disable,
    {130, "minimum_velocity", {"v_min", "minimum_speed"}, rw, true, 0, v_max, 1, "internal",
     "speed at which the end of a ramp may stop at once; keep it at 1"},
    {135, "actual_acceleration", {"a_actual", ""}, r, false, -v_max, v_max, 0, "internal", "present acceleration"},
    {138, "ramp_mode", {"ramp_type", ""}, rw, true, 0, 2, 0, "",
     "0 position, 1 soft, 2 velocity; set by ROR, ROL, MST and MVP"},
    microstep_resolution,
    {141, "reference_switch_tolerance", {"ref_switch_tolerance", ""}, rw, false, 0, 4095, 0, "microstep",
     "how far a reference switch may be off before that counts as an error"},
    {153, "ramp_divisor", {"ramp_div", ""}, rw, true, 0, 13, 3, "2^n",
     "scale of accelerations, as an exponent of two"},
    {154, "pulse_divisor", {"pulse_div", ""}, rw, true, 0, 13, 2, "2^n",
     "scale of speeds and accelerations, as an exponent of two"},
    {200, "boost_current", {"", ""}, rw, true, 0, 255, 0, "1/255", "current while accelerating; 0: as while moving"},
});

// Registers of the TMC457 and their numbers from the application note "Motion Control Profile Parameterization", the
// other numbers and the currents from the firmware manual of the TMCM-142 (pages 29 and 39). No document at hand says
// what a module starts with: what is here makes it move well.
constexpr std::int32_t v457_max = 0x7FFF0000;
constexpr std::int32_t a457_max = 0xFFFFFD;
constexpr std::int32_t v457_initial = 5'000'000;
constexpr std::int32_t a457_initial = 0x6030;
constexpr auto tmc457_axis = std::to_array<ParameterInfo>({
    {0, "target_position", {"x_target", ""}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"},
    {1, "actual_position", {"x_actual", "position"}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor is; in position mode it drives to its target after that"},
    {2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v457_max, v457_max, 0, "internal",
     "speed set-point in velocity and hold mode", Scale::velocity},
    {3, "actual_velocity", {"v_actual", "actual_speed"}, r, false, -v457_max, v457_max, 0, "internal", "present speed",
     Scale::velocity},
    {4, "max_velocity", {"v_max", "max_positioning_speed"}, rw, true, 0, v457_max, v457_initial, "internal",
     "greatest speed of a positioning move", Scale::velocity},
    {5, "max_acceleration", {"a_max_d_max", ""}, rw, true, 0, a457_max, a457_initial, "internal",
     "sets acceleration (16) and deceleration (17) together; reads the acceleration", Scale::acceleration},
    {6, "max_current", {"run_current", ""}, rw, true, 0, 15, 15, "1/15", "current while moving"},
    {7, "standby_current", {"", ""}, rw, true, 0, 15, 2, "1/15", "current at standstill"},
    position_reached, home_switch, right_switch, left_switch, right_switch_disable, left_switch_disable,
    {15, "stop_deceleration", {"d_stop", ""}, rw, true, 0, a457_max, a457_initial, "internal",
     "deceleration at a limit switch, always without bow", Scale::acceleration},
    {16, "acceleration", {"a_max", ""}, rw, true, 0, a457_max, a457_initial, "internal", "acceleration of every ramp",
     Scale::acceleration},
    {17, "max_deceleration", {"d_max", "deceleration"}, rw, true, 0, a457_max, a457_initial, "internal",
     "deceleration of every ramp; 15/16 of it with a bow", Scale::acceleration},
    {18, "max_bow", {"bow_max", "bow"}, rw, true, 0, 18, 11, "2^(n-1)",
     "how fast the acceleration may change, as an exponent of two; 0: trapezoids"},
    {128, "ramp_mode", {"ramp_type", ""}, rw, false, 0, 3, 0, "",
     "0 position, 2 velocity, 3 hold; set by ROR, ROL, MST and MVP"},
    {129, "status_flags", {"", ""}, r, false, 0, 15, 0, "bits",
     "1 position reached, 2 velocity reached, 4 stands, 8 encoder warning"},
    {130, "velocity_reached", {"", ""}, r, false, 0, 1, 0, "flag", "1 while the speed is the one asked for"},
    microstep_resolution,
    {unit_mode, "unit_mode", {"", ""}, rw, true, 0, 1, 0, "",
     "velocities and accelerations: 0 units of the TMC457, 1 microsteps per second"},
});

// Numbers from the firmware manual of the TMCM-3212 and PyTrinamic's list for the TMCM-6212, ranges from the data sheet
// of the TMC5130, what a module starts with from the vendor's open firmware of the TMC5130-HBS-KIT.
constexpr std::int32_t v6p_max = in_pps((1 << 23) - 512, sixpoint_velocity_unit);
constexpr std::int32_t v1_max = in_pps((1 << 20) - 1, sixpoint_velocity_unit);
constexpr std::int32_t v_edge_max = in_pps((1 << 18) - 1, sixpoint_velocity_unit);
constexpr std::int32_t a6p_max = in_pps((1 << 16) - 1, sixpoint_acceleration_unit);
constexpr auto sixpoint_axis = std::to_array<ParameterInfo>({
    {0, "target_position", {"xtarget", ""}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"},
    {1, "actual_position", {"xactual", "position"}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor is; in position mode it drives to its target after that"},
    {2, "target_velocity", {"", "target_speed"}, rw, false, -v6p_max, v6p_max, 0, "pps",
     "writing it makes the motor turn, as ROR and ROL do; reads the speed that the ramp goes up to", Scale::velocity},
    {3, "actual_velocity", {"vactual", "actual_speed"}, r, false, -v6p_max, v6p_max, 0, "pps", "present speed",
     Scale::velocity},
    {4, "max_velocity", {"vmax", "max_positioning_speed"}, rw, true, 0, v6p_max, 51200, "pps",
     "greatest speed of a positioning move", Scale::velocity},
    {5, "max_acceleration", {"amax", ""}, rw, true, 0, a6p_max, 51200, "pps/s",
     "acceleration above velocity V1, and every ramp of ROR, ROL and MST", Scale::acceleration},
    {6, "max_current", {"run_current", ""}, rw, true, 0, 255, 128, "1/255",
     "current while moving, as a part of the module's greatest; effective in steps of 8"},
    {7, "standby_current", {"", ""}, rw, true, 0, 255, 8, "1/255", "current at standstill"},
    position_reached, home_switch, right_switch, left_switch, right_switch_disable, left_switch_disable,
    {15, "acceleration_a1", {"a1", ""}, rw, true, 0, a6p_max, 25600, "pps/s", "acceleration up to velocity V1",
     Scale::acceleration},
    {16, "velocity_v1", {"v1", ""}, rw, true, 0, v1_max, 25600, "pps",
     "where A1 ends and D1 begins; 0: neither is used", Scale::velocity},
    {17, "max_deceleration", {"dmax", "deceleration"}, rw, true, 0, a6p_max, 51200, "pps/s",
     "deceleration down to velocity V1", Scale::acceleration},
    {18, "deceleration_d1", {"d1", ""}, rw, true, 0, a6p_max, 25600, "pps/s",
     "deceleration below velocity V1; never 0 when positioning", Scale::acceleration},
    {19, "start_velocity", {"vstart", ""}, rw, true, 0, v_edge_max, 1, "pps", "speed a ramp begins with",
     Scale::velocity},
    {20, "stop_velocity", {"vstop", ""}, rw, true, 0, v_edge_max, 10, "pps",
     "speed a ramp may stop from; 10 at least, and no less than the start velocity", Scale::velocity},
    {21, "ramp_wait_time", {"tzerowait", ""}, rw, true, 0, 65535, 0, "32 us",
     "standstill after a ramp, before the motor turns round or moves again"},
    {127, "relative_positioning_option", {"", ""}, rw, false, 0, 1, 0, "",
     "what MVP REL counts from: 0 the target position, 1 the actual position"},
    microstep_resolution,
    {unit_mode, "unit_mode", {"", ""}, rw, true, 0, 1, 1, "",
     "velocities and accelerations: 0 units of the chip, 1 microsteps per second"},
});

constexpr auto global_bank0 = std::to_array<ParameterInfo>({
    {64, "eeprom_magic", {"", ""}, rw, true, 0, 255, 228, "", "anything but 228: factory defaults at the next start"},
    {65, "serial_baud_rate", {"rs485_baud_rate", ""}, rw, true, 0, 11, 0, "code",
     "0 9600, 1 14400, 2 19200, 3 28800, 4 38400, 5 57600, 6 76800, 7 115200, 8 230400, 9 250000, 10 500000, "
     "11 1000000 baud"},
    {66, "serial_address", {"module_address", ""}, rw, true, 0, 255, 1, "", "address on serial lines"},
    {68, "serial_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
     "without a command for so long the motors stop; 0: never"},
    {69, "can_bit_rate", {"", ""}, rw, true, 1, 8, 8, "code",
     "1 10k, 2 20k, 3 50k, 4 100k, 5 125k, 6 250k, 7 500k, 8 1M bit/s"},
    {70, "can_reply_id", {"can_send_id", ""}, rw, true, 0, 0x7FF, 2, "", "identifier of the module's replies"},
    {71, "can_id", {"can_receive_id", ""}, rw, true, 0, 0x7FF, 1, "", "identifier the module listens to"},
    {73, "eeprom_lock", {"", ""}, rw, true, 0, 4321, 0, "",
     "1234 locks the configuration EEPROM, 4321 unlocks it; reads 1 while it is locked"},
    {75, "telegram_pause_time", {"", ""}, rw, true, 0, 255, 0, "ms", "wait before a reply on serial lines"},
    {76, "serial_host_address", {"", ""}, rw, true, 0, 255, 2, "", "first byte of the module's serial replies"},
    {82, "can_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
     "without a command for so long the motors stop; 0: never"},
    {83, "can_secondary_address", {"", ""}, rw, true, 0, 0x7FF, 0, "", "second identifier it listens to; 0: none"},
    {84, "coordinate_storage", {"eeprom_coordinate_store", ""}, rw, true, 0, 1, 0, "",
     "coordinates: 0 in RAM only, 1 in the EEPROM as well"},
    {85, "zero_user_variables", {"", ""}, rw, true, 0, 1, 0, "flag", "1: user variables are 0 after a start"},
    {87, "serial_secondary_address", {"", ""}, rw, true, 0, 255, 0, "", "second address it listens to; 0: none"},
    {132, "tick_timer", {"", ""}, rw, false, 0, INT32_MAX, 0, "ms", "time since the module started"},
    {133, "random_number", {"", ""}, r, false, 0, INT32_MAX, 0, "", "another one at each reading"},
    {255, "suppress_reply", {"", ""}, rw, false, 0, 1, 0, "flag", "1: no replies to commands that set something"},
});
// clang-format on

consteval bool is_sound(std::span<const ParameterInfo> table) {
  return std::ranges::is_sorted(table, {}, &ParameterInfo::number) &&
         std::ranges::all_of(table, [](const ParameterInfo& row) {
           return row.minimum <= row.initial && row.initial <= row.maximum;
         });
}
static_assert(is_sound(tmc429_axis));
static_assert(is_sound(tmc457_axis));
static_assert(is_sound(sixpoint_axis));
static_assert(is_sound(global_bank0));

constexpr PulsesPerSecond one_of(RegisterUnit unit) {
  return {static_cast<double>(unit.numerator) / static_cast<double>(unit.denominator)};
}

bool goes_by(const ParameterInfo& row, std::string_view name) {
  if (text::equal_as_name(row.name, name)) return true;
  return std::ranges::any_of(row.aliases, [&](std::string_view alias) {
    return !alias.empty() && text::equal_as_name(alias, name);
  });
}

}  // namespace

std::span<const ParameterInfo> axis_parameters(Family family) {
  switch (family) {
    case Family::tmc429: return tmc429_axis;
    case Family::tmc457: return tmc457_axis;
    case Family::sixpoint: return sixpoint_axis;
  }
  return {};
}

std::uint8_t velocity_unit_parameter(Family family) {
  return family == Family::tmc429 ? pulse_divisor : unit_mode;
}

std::optional<PulsesPerSecond> velocity_unit(Family family, std::int32_t value) {
  const auto* row = find_parameter(axis_parameters(family), velocity_unit_parameter(family));
  if (value < row->minimum || value > row->maximum) return std::nullopt;
  switch (family) {
    case Family::tmc429:
      return to_pps(InternalVelocity{1}, {.pulse = static_cast<std::uint8_t>(value)});
    case Family::tmc457: return value == 0 ? one_of(tmc457_velocity_unit) : PulsesPerSecond{1};
    case Family::sixpoint: return value == 0 ? one_of(sixpoint_velocity_unit) : PulsesPerSecond{1};
  }
  return std::nullopt;
}

std::span<const ParameterInfo> global_parameters() { return global_bank0; }

const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::uint8_t number) {
  const auto row = std::ranges::lower_bound(table, number, {}, &ParameterInfo::number);
  return row != table.end() && row->number == number ? &*row : nullptr;
}

const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::string_view name) {
  const auto row =
      std::ranges::find_if(table, [&](const ParameterInfo& info) { return goes_by(info, name); });
  return row != table.end() ? &*row : nullptr;
}

}  // namespace tmcl

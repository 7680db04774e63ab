#include "tmcl/parameter.hpp"

#include <algorithm>

#include "core/text.hpp"

namespace tmcl {
namespace {

constexpr auto r = Access::read;
constexpr auto rw = Access::read_write;
constexpr std::int32_t x_max = (1 << 23) - 1;  // 24-bit positions
constexpr std::int32_t x_min = -(1 << 23);
constexpr std::int32_t v_max = 2047;  // 11-bit speeds and a sign

// clang-format off
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
    {8, "position_reached", {"position_reached_flag", ""}, r, false, 0, 1, 0, "flag",
     "1 while the actual position equals the target"},
    {9, "home_switch", {"reference_switch_status", ""}, r, false, 0, 1, 0, "flag", "state of the home switch"},
    {10, "right_limit_switch", {"right_endstop", ""}, r, false, 0, 1, 0, "flag", "state of the right limit switch"},
    {11, "left_limit_switch", {"left_endstop", ""}, r, false, 0, 1, 0, "flag", "state of the left limit switch"},
    {12, "right_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag", "1: the right limit switch does not stop"},
    {13, "left_limit_switch_disable", {"", ""}, rw, true, 0, 1, 0, "flag", "1: the left limit switch does not stop"},
    {130, "minimum_velocity", {"v_min", "minimum_speed"}, rw, true, 0, v_max, 1, "internal",
     "speed at which the end of a ramp may stop at once; keep it at 1"},
    {135, "actual_acceleration", {"a_actual", ""}, r, false, -v_max, v_max, 0, "internal", "present acceleration"},
    {138, "ramp_mode", {"ramp_type", ""}, rw, true, 0, 2, 0, "",
     "0 position, 1 soft, 2 velocity; set by ROR, ROL, MST and MVP"},
    {140, "microstep_resolution", {"usrs", ""}, rw, true, 0, 8, 8, "2^n",
     "microsteps of a full step, as an exponent of two"},
    {141, "reference_switch_tolerance", {"ref_switch_tolerance", ""}, rw, false, 0, 4095, 0, "microstep",
     "how far a reference switch may be off before that counts as an error"},
    {153, "ramp_divisor", {"ramp_div", ""}, rw, true, 0, 13, 3, "2^n",
     "scale of accelerations, as an exponent of two"},
    {154, "pulse_divisor", {"pulse_div", ""}, rw, true, 0, 13, 2, "2^n",
     "scale of speeds and accelerations, as an exponent of two"},
    {200, "boost_current", {"", ""}, rw, true, 0, 255, 0, "1/255", "current while accelerating; 0: as while moving"},
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
    {75, "telegram_pause_time", {"", ""}, rw, true, 0, 255, 0, "ms", "wait before a reply on serial lines"},
    {76, "serial_host_address", {"", ""}, rw, true, 0, 255, 2, "", "first byte of the module's serial replies"},
    {82, "can_heartbeat", {"", ""}, rw, true, 0, 65535, 0, "ms",
     "without a command for so long the motors stop; 0: never"},
    {83, "can_secondary_address", {"", ""}, rw, true, 0, 0x7FF, 0, "", "second identifier it listens to; 0: none"},
    {87, "serial_secondary_address", {"", ""}, rw, true, 0, 255, 0, "", "second address it listens to; 0: none"},
    {132, "tick_timer", {"", ""}, rw, false, 0, INT32_MAX, 0, "ms", "time since the module started"},
    {255, "suppress_reply", {"", ""}, rw, false, 0, 1, 0, "flag", "1: no replies to commands that set something"},
});
// clang-format on

static_assert(std::ranges::is_sorted(tmc429_axis, {}, &ParameterInfo::number));
static_assert(std::ranges::is_sorted(global_bank0, {}, &ParameterInfo::number));
static_assert(std::ranges::all_of(tmc429_axis, [](const ParameterInfo& row) {
  return row.minimum <= row.initial && row.initial <= row.maximum;
}));

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
  }
  return {};
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

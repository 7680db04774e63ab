#include "core/common_axis_parameters.hpp"
#include "tmcl/units.hpp"

namespace tmcl {
namespace {

using namespace row;

// The greatest whole number of microsteps per second that a register holds.
constexpr std::int32_t in_pps(std::int64_t greatest, RegisterUnit unit) {
  return static_cast<std::int32_t>(greatest * unit.numerator / unit.denominator);
}

// Numbers from the firmware manual of the TMCM-3212 and PyTrinamic's list for the TMCM-6212, ranges
// from the data sheet of the TMC5130, what a module starts with from the vendor's open firmware of
// the TMC5130-HBS-KIT.
constexpr std::int32_t v6p_max = in_pps((1 << 23) - 512, sixpoint_velocity_unit);
constexpr std::int32_t v1_max = in_pps((1 << 20) - 1, sixpoint_velocity_unit);
constexpr std::int32_t v_edge_max = in_pps((1 << 18) - 1, sixpoint_velocity_unit);
constexpr std::int32_t a6p_max = in_pps((1 << 16) - 1, sixpoint_acceleration_unit);
// clang-format off
constexpr auto sixpoint_axis = std::to_array<ParameterRow>({
    {{0, "target_position", {"xtarget", ""}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"}},
    {{1, "actual_position", {"xactual", "position"}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor is; in position mode it drives to its target after that"}},
    {{2, "target_velocity", {"", "target_speed"}, rw, false, -v6p_max, v6p_max, 0, "pps",
     "writing it makes the motor turn, as ROR and ROL do; reads the speed that the ramp goes up to", "", Scale::velocity}},
    {{3, "actual_velocity", {"vactual", "actual_speed"}, r, false, -v6p_max, v6p_max, 0, "pps", "present speed", "",
     Scale::velocity}},
    {{4, "max_velocity", {"vmax", "max_positioning_speed"}, rw, true, 0, v6p_max, 51200, "pps",
     "greatest speed of a positioning move", "", Scale::velocity}},
    {{5, "max_acceleration", {"amax", ""}, rw, true, 0, a6p_max, 51200, "pps/s",
     "acceleration above velocity V1, and every ramp of ROR, ROL and MST", "", Scale::acceleration}},
    {{6, "max_current", {"run_current", ""}, rw, true, 0, 255, 128, "1/255",
     "current while moving, as a part of the module's greatest; effective in steps of 8"}},
    {{7, "standby_current", {"", ""}, rw, true, 0, 255, 8, "1/255", "current at standstill"}},
    {position_reached}, {home_switch}, {right_switch}, {left_switch}, {right_switch_disable}, {left_switch_disable},
    {{15, "acceleration_a1", {"a1", ""}, rw, true, 0, a6p_max, 25600, "pps/s", "acceleration up to velocity V1", "",
     Scale::acceleration}},
    {{16, "velocity_v1", {"v1", ""}, rw, true, 0, v1_max, 25600, "pps",
     "where A1 ends and D1 begins; 0: neither is used", "", Scale::velocity}},
    {{17, "max_deceleration", {"dmax", "deceleration"}, rw, true, 0, a6p_max, 51200, "pps/s",
     "deceleration down to velocity V1", "", Scale::acceleration}},
    {{18, "deceleration_d1", {"d1", ""}, rw, true, 0, a6p_max, 25600, "pps/s",
     "deceleration below velocity V1; never 0 when positioning", "", Scale::acceleration}},
    {{19, "start_velocity", {"vstart", ""}, rw, true, 0, v_edge_max, 1, "pps", "speed a ramp begins with", "",
     Scale::velocity}},
    {{20, "stop_velocity", {"vstop", ""}, rw, true, 0, v_edge_max, 10, "pps",
     "speed a ramp may stop from; 10 at least, and no less than the start velocity", "", Scale::velocity}},
    {{21, "ramp_wait_time", {"tzerowait", ""}, rw, true, 0, 65535, 0, "32 us",
     "standstill after a ramp, before the motor turns round or moves again"}},
    {{127, "relative_positioning_option", {"", ""}, rw, false, 0, 1, 0, "",
     "what MVP REL counts from: 0 the target position, 1 the actual position"}},
    {microstep_resolution},
    {{255, "unit_mode", {"", ""}, rw, true, 0, 1, 1, "",
     "velocities and accelerations: 0 units of the chip, 1 microsteps per second"}},
});
// clang-format on

static_assert(is_sound(sixpoint_axis, models_of(Family::sixpoint)));

}  // namespace

std::span<const ParameterRow> sixpoint_axis_rows() { return sixpoint_axis; }

}  // namespace tmcl

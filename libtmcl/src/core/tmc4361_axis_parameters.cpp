#include "core/common_axis_parameters.hpp"

namespace tmcl {
namespace {

using namespace row;
constexpr std::int32_t v_max = (1 << 22) - 1;
constexpr std::int32_t a_max = (1 << 22) - 1;

// clang-format off
constexpr auto tmc4361_axis = std::to_array<ParameterRow>({
    {{0, "target_position", {"x_target", ""}, rw, false, x_least, x_greatest, 0, "microstep",
      "where the motor goes; writing it in position mode starts a ramp", "X_TARGET"}},
    {{1, "actual_position", {"x_actual", "position"}, rw, false, x_least, x_greatest, 0, "microstep",
      "where the motor is; in position mode it drives to its target after that", "XACTUAL"}},
    {{2, "target_velocity", {"", "target_speed"}, rw, false, -v_max, v_max, 0, "pps",
      "writing it makes the motor turn, as ROR and ROL do; reads the speed that the ramp goes up to", "VMAX", Scale::velocity}},
    {{3, "actual_velocity", {"vactual", "actual_speed"}, r, false, -v_max, v_max, 0, "pps", "present speed",
      "VACTUAL", Scale::velocity}},
    {{4, "max_velocity", {"vmax", "max_positioning_speed"}, rw, true, 0, v_max, 51200, "pps",
      "greatest speed of a positioning move", "VMAX", Scale::velocity}},
    {{5, "max_acceleration", {"amax", ""}, rw, true, 0, a_max, 51200, "pps/s",
      "acceleration above the break velocity", "AMAX", Scale::acceleration}},
    {{6, "max_current", {"run_current", ""}, rw, true, 0, 255, 128, "1/255",
      "current while moving, as a part of the module's greatest; effective in steps of 8"}},
    {{7, "standby_current", {"", ""}, rw, true, 0, 255, 8, "1/255", "current at standstill"}},
    {position_reached},
    {home_switch},
    {right_switch},
    {left_switch},
    {right_switch_disable},
    {left_switch_disable},
    {microstep_resolution},
});
// clang-format on

static_assert(is_sound(tmc4361_axis, models_of(Family::tmc4361)));

}  // namespace

std::span<const ParameterRow> tmc4361_axis_rows() { return tmc4361_axis; }

}  // namespace tmcl

#include "core/common_axis_parameters.hpp"

namespace tmcl {
namespace {

using namespace row;

constexpr std::int32_t x_max = (1 << 23) - 1;  // 24-bit positions
constexpr std::int32_t x_min = -(1 << 23);
constexpr std::int32_t v_max = 2047;  // 11-bit speeds and a sign

// Ranges and meanings from the firmware manuals of the TMCM-6110 and TMCM-351; what a module starts
// with from the open firmware of the TMCM-1110.
// clang-format off
constexpr auto tmc429_axis = std::to_array<ParameterRow>({
    {{0, "target_position", {"x_target", ""}, rw, false, x_min, x_max, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"}},
    {{1, "actual_position", {"x_actual", "position"}, rw, false, x_min, x_max, 0, "microstep",
     "where the motor is; set it only at standstill or in velocity mode"}},
    {{2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v_max, v_max, 0, "internal",
     "speed set-point in velocity mode; in position mode what the ramp asks for"}},
    {{3, "actual_velocity", {"v_actual", "actual_speed"}, r, false, -v_max, v_max, 0, "internal", "present speed"}},
    {{4, "max_velocity", {"v_max", "max_positioning_speed"}, rw, true, 0, v_max, 1000, "internal",
     "greatest speed of a positioning move"}},
    {{5, "max_acceleration", {"a_max", ""}, rw, true, 0, v_max, 500, "internal",
     "acceleration and deceleration of every ramp"}},
    {{6, "max_current", {"run_current", ""}, rw, true, 0, 255, 255, "1/255",
     "current while moving, as a part of the module's greatest; effective in steps of 8"}},
    {{7, "standby_current", {"", ""}, rw, true, 0, 255, 32, "1/255", "current at standstill"}},
    {position_reached}, {home_switch}, {right_switch}, {left_switch}, {right_switch_disable}, {left_switch_disable},
    {{130, "minimum_velocity", {"v_min", "minimum_speed"}, rw, true, 0, v_max, 1, "internal",
     "speed at which the end of a ramp may stop at once; keep it at 1"}},
    {{135, "actual_acceleration", {"a_actual", ""}, r, false, -v_max, v_max, 0, "internal", "present acceleration"}},
    {{138, "ramp_mode", {"ramp_type", ""}, rw, true, 0, 2, 0, "",
     "0 position, 1 soft, 2 velocity; set by ROR, ROL, MST and MVP"}},
    {microstep_resolution},
    {{141, "reference_switch_tolerance", {"ref_switch_tolerance", ""}, rw, false, 0, 4095, 0, "microstep",
     "how far a reference switch may be off before that counts as an error"}},
    {{153, "ramp_divisor", {"ramp_div", ""}, rw, true, 0, 13, 3, "2^n",
     "scale of accelerations, as an exponent of two"}},
    {{154, "pulse_divisor", {"pulse_div", ""}, rw, true, 0, 13, 2, "2^n",
     "scale of speeds and accelerations, as an exponent of two"}},
    {{200, "boost_current", {"", ""}, rw, true, 0, 255, 0, "1/255", "current while accelerating; 0: as while moving"}},
});
// clang-format on

static_assert(is_sound(tmc429_axis, models_of(Family::tmc429)));

}  // namespace

std::span<const ParameterRow> tmc429_axis_rows() { return tmc429_axis; }

}  // namespace tmcl

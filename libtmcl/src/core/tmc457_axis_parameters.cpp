#include "core/common_axis_parameters.hpp"

namespace tmcl {
namespace {

using namespace row;

// Registers of the TMC457 and their numbers from the application note "Motion Control Profile
// Parameterization", the other numbers and the currents from the firmware manual of the TMCM-142
// (pages 29 and 39). No document at hand says what a module starts with: what is here makes it move
// well.
constexpr std::int32_t v457_max = 0x7FFF0000;
constexpr std::int32_t a457_max = 0xFFFFFD;
constexpr std::int32_t v457_initial = 5'000'000;
constexpr std::int32_t a457_initial = 0x6030;
// clang-format off
constexpr auto tmc457_axis = std::to_array<ParameterRow>({
    {{0, "target_position", {"x_target", ""}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor goes; writing it in position mode starts a ramp"}},
    {{1, "actual_position", {"x_actual", "position"}, rw, false, x_least, x_greatest, 0, "microstep",
     "where the motor is; in position mode it drives to its target after that"}},
    {{2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v457_max, v457_max, 0, "internal",
     "speed set-point in velocity and hold mode", "", Scale::velocity}},
    {{3, "actual_velocity", {"v_actual", "actual_speed"}, r, false, -v457_max, v457_max, 0, "internal", "present speed", "",
     Scale::velocity}},
    {{4, "max_velocity", {"v_max", "max_positioning_speed"}, rw, true, 0, v457_max, v457_initial, "internal",
     "greatest speed of a positioning move", "", Scale::velocity}},
    {{5, "max_acceleration", {"a_max_d_max", ""}, rw, true, 0, a457_max, a457_initial, "internal",
     "sets acceleration (16) and deceleration (17) together; reads the acceleration", "", Scale::acceleration}},
    {{6, "max_current", {"run_current", ""}, rw, true, 0, 15, 15, "1/15", "current while moving"}},
    {{7, "standby_current", {"", ""}, rw, true, 0, 15, 2, "1/15", "current at standstill"}},
    {position_reached}, {home_switch}, {right_switch}, {left_switch}, {right_switch_disable}, {left_switch_disable},
    {{15, "stop_deceleration", {"d_stop", ""}, rw, true, 0, a457_max, a457_initial, "internal",
     "deceleration at a limit switch, always without bow", "", Scale::acceleration}},
    {{16, "acceleration", {"a_max", ""}, rw, true, 0, a457_max, a457_initial, "internal", "acceleration of every ramp", "",
     Scale::acceleration}},
    {{17, "max_deceleration", {"d_max", "deceleration"}, rw, true, 0, a457_max, a457_initial, "internal",
     "deceleration of every ramp; 15/16 of it with a bow", "", Scale::acceleration}},
    {{18, "max_bow", {"bow_max", "bow"}, rw, true, 0, 18, 11, "2^(n-1)",
     "how fast the acceleration may change, as an exponent of two; 0: trapezoids"}},
    {{128, "ramp_mode", {"ramp_type", ""}, rw, false, 0, 3, 0, "",
     "0 position, 2 velocity, 3 hold; set by ROR, ROL, MST and MVP"}},
    {{129, "status_flags", {"", ""}, r, false, 0, 15, 0, "bits",
     "1 position reached, 2 velocity reached, 4 stands, 8 encoder warning"}},
    {{130, "velocity_reached", {"", ""}, r, false, 0, 1, 0, "flag", "1 while the speed is the one asked for"}},
    {microstep_resolution},
    {{255, "unit_mode", {"", ""}, rw, true, 0, 1, 0, "",
     "velocities and accelerations: 0 units of the TMC457, 1 microsteps per second"}},
});
// clang-format on

static_assert(is_sound(tmc457_axis, models_of(Family::tmc457)));

}  // namespace

std::span<const ParameterRow> tmc457_axis_rows() { return tmc457_axis; }

}  // namespace tmcl

#include "core/common_axis_parameters.hpp"

namespace tmcl {
namespace {

using namespace row;

// Registers of the TMC457 and their numbers from the application note "Motion Control Profile
// Parameterization", the other numbers and the currents from the firmware manual of the TMCM-142
// (pages 29 and 39). No document at hand says what a module starts with: what is here makes it move
// well.
constexpr std::int32_t v_max = 0x7FFF0000;
constexpr Speeds speed{v_max, "internal", Scale::velocity};
constexpr std::int32_t a_max = 0xFFFFFD;
constexpr std::int32_t v_initial = 5'000'000;
constexpr std::int32_t a_initial = 0x6030;
// clang-format off
constexpr auto tmc457_axis = std::to_array<ParameterRow>({
    {target_position(positions, {"X_TARGET", "x_target"})},
    {actual_position(positions, {"X_ACTUAL", "x_actual"})},
    {{2, "target_velocity", {"v_target", "target_speed"}, rw, false, -v_max, v_max, 0, "internal",
      "speed set-point in velocity and hold mode", "V_TARGET", Scale::velocity}},
    {actual_velocity(speed, {"V_ACTUAL", "v_actual"})},
    {max_velocity(speed, v_initial, {"V_MAX", "v_max"})},
    {{5, "max_acceleration", {"a_max_d_max", ""}, rw, true, 0, a_max, a_initial, "internal",
      "sets acceleration (16) and deceleration (17) together; reads the acceleration", "A_MAX_D_MAX",
      Scale::acceleration}},
    {{6, "max_current", {"run_current", ""}, rw, true, 0, 15, 15, "1/15",
      "current while moving"}},
    {{7, "standby_current", {"", ""}, rw, true, 0, 15, 2, "1/15",
      "current at standstill"}},
    {position_reached},
    {home_switch},
    {right_switch},
    {left_switch},
    {right_switch_disable},
    {left_switch_disable},
    {{15, "stop_deceleration", {"d_stop", ""}, rw, true, 0, a_max, a_initial, "internal",
      "deceleration at a limit switch, always without bow", "D_STOP", Scale::acceleration}},
    {{16, "acceleration", {"a_max", ""}, rw, true, 0, a_max, a_initial, "internal",
      "acceleration of every ramp", "A_MAX", Scale::acceleration}},
    {{17, "max_deceleration", {"d_max", "deceleration"}, rw, true, 0, a_max, a_initial, "internal",
      "deceleration of every ramp; 15/16 of it with a bow", "D_MAX", Scale::acceleration}},
    {{18, "max_bow", {"bow_max", "bow"}, rw, true, 0, 18, 11, "2^(n-1)",
      "how fast the acceleration may change, as an exponent of two; 0: trapezoids", "BOW_MAX"}},
    {{41, "encoder_position", {"x_enc", ""}, rw, false, x_least, x_greatest, 0, "microstep",
      "what the encoder reads", "ENC_POS"}},
    {{128, "ramp_mode", {"ramp_type", ""}, rw, false, 0, 3, 0, "",
      "0 position, 2 velocity, 3 hold; set by ROR, ROL, MST and MVP", "MODE"}},
    {{129, "status_flags", {"", ""}, r, false, 0, 15, 0, "bits",
      "1 position reached, 2 velocity reached, 4 stands, 8 encoder warning", "STATUS"}},
    {{130, "velocity_reached", {"", ""}, r, false, 0, 1, 0, "flag",
      "1 while the speed is the one asked for", "STATUS"}},
    {in_register(microstep_resolution, "USTEP_RES")},
    {{193, "reference_search_mode", {"", ""}, rw, true, 1, 3, 1, "",
      "1 left switch, 2 right switch, then left, 3 right switch, then home"}},
    {search_speed(speed, v_initial / 2)},
    {switch_speed(speed, v_initial / 10)},
    {reference_switch_distance},
    {extended_error_flags},
    {{212, "max_encoder_deviation", {"", ""}, rw, true, 0, x_greatest, 0, "microstep",
      "the motor stops where encoder (41) and position differ by more; 0: never"}},
    {{255, "unit_mode", {"", ""}, rw, true, 0, 1, 0, "",
      "velocities and accelerations: 0 units of the TMC457, 1 microsteps per second"}},
});
// clang-format on

static_assert(is_sound(tmc457_axis, Family::tmc457));

}  // namespace

std::span<const ParameterRow> tmc457_axis_rows() { return tmc457_axis; }

}  // namespace tmcl

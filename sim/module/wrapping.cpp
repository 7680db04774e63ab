#include "sim/module/wrapping.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace tmcl::sim {
namespace {

constexpr unsigned velocity_bits = 12;
constexpr std::int32_t greatest_wrapping_velocity = 2047;

enum class Rule : std::uint8_t {
  unsigned_bits,  ///< A register of `size` bits.
  signed_bits,    ///< One with a sign.
  velocity,       ///< See wrapped_velocity().
  flag,           ///< 1 if one of the `size` low bits is set.
  remembered,     ///< Kept as it is; the chip gets the `size` low bits.
  byte,           ///< A byte of memory.
  byte_at_most,   ///< One that is made `size` where it is more.
  signed_byte,    ///< One with a sign that is brought into -size..size.
};

struct WrappingRow {
  std::string_view parameter;
  Rule rule;
  unsigned size = 0;
};

// From Commands.c, TMC429.c and TMC262.c of TMCL-LITE-1110. Not here, and so refused as the manual
// has it: what it does not have or never writes (204, 214), what it writes past the end of a field
// or a register (140, 175, 176, 178), and what it counts in another way (165).
constexpr auto wrapping_rows = std::to_array<WrappingRow>({
    {"target_position", Rule::signed_bits, 24},
    {"actual_position", Rule::signed_bits, 24},
    {"target_velocity", Rule::velocity},
    {"max_velocity", Rule::remembered, 11},
    {"max_acceleration", Rule::remembered, 11},
    {"max_current", Rule::byte},
    {"standby_current", Rule::byte},
    {"right_limit_switch_disable", Rule::flag, 8},
    {"left_limit_switch_disable", Rule::flag, 8},
    {"minimum_velocity", Rule::unsigned_bits, 11},
    {"ramp_mode", Rule::unsigned_bits, 2},
    {"reference_switch_tolerance", Rule::unsigned_bits, 12},
    {"soft_stop", Rule::flag, 32},
    {"ramp_divisor", Rule::unsigned_bits, 4},
    {"pulse_divisor", Rule::unsigned_bits, 4},
    {"step_interpolation", Rule::byte},
    {"double_edge_steps", Rule::byte},
    {"chopper_blank_time", Rule::byte_at_most, 3},
    {"constant_toff_mode", Rule::byte},
    {"disable_fast_decay_comparator", Rule::byte_at_most, 3},
    {"chopper_hysteresis_start", Rule::byte_at_most, 7},
    {"toff", Rule::byte_at_most, 15},
    {"smart_energy_current_minimum", Rule::byte_at_most, 1},
    {"smart_energy_current_down_step", Rule::byte_at_most, 3},
    {"smart_energy_hysteresis", Rule::byte_at_most, 15},
    {"smart_energy_current_up_step", Rule::byte_at_most, 3},
    {"smart_energy_hysteresis_start", Rule::byte},
    {"stallguard2_filter_enable", Rule::byte},
    {"stallguard2_threshold", Rule::signed_byte, 63},
    {"short_protection_disable", Rule::byte},
    {"vsense", Rule::byte},
    {"smart_energy_stall_velocity", Rule::remembered, 32},
    {"smart_energy_threshold_speed", Rule::remembered, 32},
    {"smart_energy_slow_run_current", Rule::byte},
    {"random_toff_mode", Rule::byte},
});

constexpr std::uint32_t low_bits(std::int64_t value, unsigned size) {
  const auto mask = size < 32 ? (std::uint32_t{1} << size) - 1 : ~std::uint32_t{0};
  return static_cast<std::uint32_t>(value) & mask;
}

constexpr std::int32_t unsigned_field(std::int64_t value, unsigned size) {
  return static_cast<std::int32_t>(low_bits(value, size));
}

constexpr std::int32_t signed_field(std::int64_t value, unsigned size) {
  const unsigned spare = 32 - size;
  return static_cast<std::int32_t>(low_bits(value, size) << spare) >> spare;
}

const WrappingRow* find(std::string_view parameter) {
  const auto* row = std::ranges::find(wrapping_rows, parameter, &WrappingRow::parameter);
  return row == wrapping_rows.end() ? nullptr : row;
}

std::int32_t kept(const WrappingRow& row, std::int32_t value) {
  constexpr unsigned byte = 8;
  const auto size = static_cast<std::int32_t>(row.size);
  switch (row.rule) {
    case Rule::unsigned_bits: return unsigned_field(value, row.size);
    case Rule::signed_bits: return signed_field(value, row.size);
    case Rule::velocity: return wrapped_velocity(value);
    case Rule::flag: return low_bits(value, row.size) != 0 ? 1 : 0;
    case Rule::remembered: return value;
    case Rule::byte: return unsigned_field(value, byte);
    case Rule::byte_at_most: return std::min(unsigned_field(value, byte), size);
    case Rule::signed_byte: return std::clamp(signed_field(value, byte), -size, size);
  }
  return value;
}

std::int32_t written(const WrappingRow& row, const ParameterInfo& info, std::int32_t value) {
  switch (row.rule) {
    case Rule::unsigned_bits:
    case Rule::signed_bits:
    case Rule::velocity:
    case Rule::flag: return kept(row, value);
    case Rule::remembered: value = unsigned_field(value, row.size); break;
    default: value = kept(row, value); break;
  }
  return std::clamp(value, info.minimum, info.maximum);
}

}  // namespace

std::optional<Wrapped> wrapped(const ParameterInfo& info, std::int32_t value) {
  const auto* row = find(info.name);
  if (row == nullptr) return std::nullopt;
  return Wrapped{kept(*row, value), written(*row, info, value)};
}

bool is_remembered(const ParameterInfo& info) {
  const auto* row = find(info.name);
  return row != nullptr && row->rule == Rule::remembered;
}

std::int32_t wrapped_velocity(std::int64_t value) {
  return std::max(signed_field(value, velocity_bits), -greatest_wrapping_velocity);
}

}  // namespace tmcl::sim

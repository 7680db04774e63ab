#include "sim/module/driver_registers.hpp"

#include <algorithm>
#include <array>

#include "tmcl/parameter_number.hpp"

namespace tmcl::sim {
namespace {

constexpr std::int32_t finest_resolution = 8;
constexpr std::int32_t current_steps = 32;

constexpr std::uint32_t mask_of(const DriverField& field) {
  return ((1U << field.bits) - 1) << field.shift;
}

std::int32_t to_bits(FieldCode code, std::int32_t value, const ParameterInfo& row) {
  switch (code) {
    case FieldCode::halvings: return finest_resolution - value;
    case FieldCode::current: return value * current_steps / (row.maximum + 1);
    case FieldCode::plain:
    case FieldCode::two_complement: break;
  }
  return value;
}

}  // namespace

// Addresses and bits: data sheets of the TMC5130A and the TMC5160A, chapter "Register Mapping".
std::span<const DriverField> driver_fields(Family family) {
  using enum FieldCode;
  static constexpr std::array<DriverField, 12> all{{
      {0x0B, 0, 8, number_of("global_current_scaler"), plain},
      {0x10, 0, 5, number_of("standby_current"), current},
      {0x10, 8, 5, number_of("max_current"), current},
      {0x6C, 0, 4, number_of("toff"), plain},
      {0x6C, 24, 4, axis_parameter::microstep_resolution, halvings},
      {0x6C, 30, 1, number_of("short_protection_disable"), plain},
      {0x6D, 0, 4, number_of("smart_energy_hysteresis_start"), plain},
      {0x6D, 5, 2, number_of("smart_energy_current_up_step"), plain},
      {0x6D, 8, 4, number_of("smart_energy_hysteresis"), plain},
      {0x6D, 13, 2, number_of("smart_energy_current_down_step"), plain},
      {0x6D, 15, 1, number_of("smart_energy_current_minimum"), plain},
      {0x6D, 16, 7, number_of("stallguard2_threshold"), two_complement},
  }};
  if (family != Family::sixpoint) return {};
  return all;
}

std::int32_t value_in(const DriverField& field, std::uint32_t word, const ParameterInfo& row) {
  const auto bits = static_cast<std::int32_t>((word & mask_of(field)) >> field.shift);
  switch (field.code) {
    case FieldCode::halvings: return std::max(finest_resolution - bits, 0);
    case FieldCode::current: return (bits + 1) * (row.maximum + 1) / current_steps - 1;
    case FieldCode::two_complement:
      return bits < 1 << (field.bits - 1) ? bits : bits - (1 << field.bits);
    case FieldCode::plain: break;
  }
  return bits;
}

std::uint32_t with_value(const DriverField& field, std::uint32_t word, std::int32_t value,
                         const ParameterInfo& row) {
  const auto bits = static_cast<std::uint32_t>(to_bits(field.code, value, row));
  return (word & ~mask_of(field)) | (bits << field.shift & mask_of(field));
}

std::int32_t driver_status(const DriverReading& reading) {
  constexpr std::int32_t greatest_load = 1023;
  constexpr unsigned scale_shift = 16;
  constexpr unsigned flags_shift = 24;
  const auto load = static_cast<std::uint32_t>(std::clamp(reading.load, 0, greatest_load));
  return static_cast<std::int32_t>(
      load | static_cast<std::uint32_t>(reading.current_scale) << scale_shift |
      static_cast<std::uint32_t>(reading.flags) << flags_shift);
}

}  // namespace tmcl::sim

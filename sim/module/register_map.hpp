/// The registers of a motion controller by their addresses in the chip, as far as the ramp
/// generator has them.
#pragma once

#include <cstdint>
#include <span>

#include "tmcl/ramp/sixpoint.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/ramp/tmc4361.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::sim {

/// Bits of a register, and what they are to the generator. One that takes negative values is all of
/// its register.
template <class Chip>
struct RegisterField {
  std::uint8_t address;
  std::uint8_t shift;
  std::uint8_t bits;
  typename Chip::Register name;
};

template <class Chip>
struct RegisterMap {
  std::uint32_t word;  ///< All bits that a register can have.
  std::span<const RegisterField<Chip>> fields;
};

/// Addresses of the first motor; without the bit that tells reading from writing.
RegisterMap<ramp::Tmc429> register_map(const ramp::Tmc429& chip);
RegisterMap<ramp::Tmc457> register_map(const ramp::Tmc457& chip);
RegisterMap<ramp::SixPoint> register_map(const ramp::SixPoint& chip);
/// Nothing: no command reaches them, because another generator drives its trapezoids.
RegisterMap<ramp::Tmc4361> register_map(const ramp::Tmc4361& chip);

/// What the chip alone writes: speeds, states, latched positions.
namespace tmc429_address {
constexpr std::uint8_t a_actual = 0x0E;
constexpr std::uint8_t x_latched = 0x1C;
}  // namespace tmc429_address
namespace tmc457_address {
constexpr std::uint8_t v_actual = 0x02;
constexpr std::uint8_t status = 0x0B;
constexpr std::uint8_t a_actual = 0x0C;
}  // namespace tmc457_address
namespace sixpoint_address {
constexpr std::uint8_t vactual = 0x22;
constexpr std::uint8_t ramp_stat = 0x35;
constexpr std::uint8_t xlatch = 0x36;
}  // namespace sixpoint_address

}  // namespace tmcl::sim

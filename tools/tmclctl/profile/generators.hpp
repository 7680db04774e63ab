/// The ramp generators by name, and what people call the values of their registers.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "profile/simulation.hpp"

namespace tmclctl::profile {

/// What a register is given if the command line does not mention it.
struct Default {
  std::string_view register_name;
  std::int64_t value;
  std::string_view at_least{};  ///< A register: if that was given more than `value`, the same.
};

/// A register that counts in parts of a unit of its data sheet; a number with a point is in that
/// unit.
struct Scale {
  std::string_view register_name;
  int bits;  ///< It holds so many powers of two of the unit.
  std::string_view unit;

  std::int64_t in_register(double number) const { return std::llround(std::ldexp(number, bits)); }
  double in_unit(std::int64_t value) const { return std::ldexp(static_cast<double>(value), -bits); }
};

struct GeneratorInfo {
  std::string_view name;
  std::span<const tmcl::ramp::RegisterInfo> registers;
  std::span<const Default> defaults;
  /// What sets the motor going, or depends on the others: written after them, in this order.
  std::span<const std::string_view> written_last;
  std::string_view time_unit;
  std::string_view length_unit;
  /// Whether how long a tick lasts depends on a clock, f_clk.
  bool clocked;
  double (*ticks_per_second)(double f_clk_hz);
  std::unique_ptr<Simulation> (*simulate)(Script script);
  std::span<const Scale> scales{};

  /// Null for a register without one.
  const Scale* scale_of(std::string_view register_name) const;
};

std::span<const GeneratorInfo> generators();

}  // namespace tmclctl::profile

/// Axis parameter 255: whether velocities and accelerations are counted as the chip does, or in
/// microsteps and seconds.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/parameter.hpp"
#include "tmcl/ramp/generator.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

/// Rounds as the vendor's open firmware of the TMC5130-HBS-KIT does: towards zero what is written,
/// away from zero what is read. So a velocity in microsteps per second reads as it was written.
/// Whether the modules with a TMC457 round in the same way is in no document.
class UnitMode {
 public:
  /// For chips whose modules have no such parameter.
  UnitMode() = default;
  UnitMode(RegisterUnit velocity, RegisterUnit acceleration, bool pps)
      : velocity_(velocity), acceleration_(acceleration), starts_in_pps_(pps), pps_(pps) {}

  /// Registers keep their values.
  void set(bool pps) { pps_ = pps; }
  bool in_pps() const { return pps_; }

  std::int32_t read(Scale scale, std::int64_t register_value) const {
    const auto unit = unit_of(scale);
    const auto scaled = register_value * unit.numerator;
    const auto up = scaled < 0 ? 1 - unit.denominator : unit.denominator - 1;
    return static_cast<std::int32_t>((scaled + up) / unit.denominator);
  }
  /// Nothing for a value beyond the range of the register, as it is in the unit of the moment.
  std::optional<std::int64_t> write(Scale scale, std::int64_t value,
                                    const ramp::RegisterInfo& range) const {
    const auto unit = unit_of(scale);
    if (value < range.minimum * unit.numerator / unit.denominator) return std::nullopt;
    if (value > range.maximum * unit.numerator / unit.denominator) return std::nullopt;
    return in_register(scale, value);
  }
  /// Whatever the register's range.
  std::int64_t in_register(Scale scale, std::int64_t value) const {
    const auto unit = unit_of(scale);
    return value * unit.denominator / unit.numerator;
  }
  /// The greatest value that a register takes, in the unit of the moment.
  std::int64_t greatest(Scale scale, const ramp::RegisterInfo& range) const {
    const auto unit = unit_of(scale);
    return range.maximum * unit.numerator / unit.denominator;
  }
  /// Whether a value is in the row's range, which counts in the unit that the module starts with.
  bool accepts(const ParameterInfo& row, std::int64_t value) const {
    if (row.scale != Scale::fixed && pps_ != starts_in_pps_) {
      const auto unit = row.scale == Scale::velocity ? velocity_ : acceleration_;
      value = pps_ ? value * unit.denominator / unit.numerator
                   : value * unit.numerator / unit.denominator;
    }
    return value >= row.minimum && value <= row.maximum;
  }

 private:
  RegisterUnit unit_of(Scale scale) const {
    if (!pps_ || scale == Scale::fixed) return {1, 1};
    return scale == Scale::velocity ? velocity_ : acceleration_;
  }

  RegisterUnit velocity_{1, 1};
  RegisterUnit acceleration_{1, 1};
  bool starts_in_pps_ = false;
  bool pps_ = false;
};

}  // namespace tmcl

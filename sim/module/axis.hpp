/// One motor of a module: its ramp generator and its axis parameters.
#pragma once

#include <array>
#include <cstdint>

#include <tl/expected.hpp>

#include "tmcl/parameter.hpp"
#include "tmcl/ramp/tmc429.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// What the firmware of a TMC429 module does with the chip; behaviour measured on the vendor's open
/// firmware of the TMCM-1110, without its errors.
class Axis {
 public:
  explicit Axis(Family family);

  /// What GAP answers: wrong_type for a number that is not in the family's table.
  tl::expected<std::int32_t, Status> get(std::uint8_t number) const;
  /// What SAP answers: wrong_type for a number that cannot be written, invalid_value out of range.
  Status set(std::uint8_t number, std::int32_t value);

  /// ROR, or ROL with the other sign: -2047..2047. Not limited by parameter 4, which the next
  /// positioning puts in force again.
  void rotate(std::int32_t velocity);
  /// MST: slows down at the acceleration of parameter 5.
  void stop();
  /// MVP; positions wrap at 24 bit.
  void move_to(std::int64_t position);

  void advance_to(ramp::Tick tick) { chip_.advance_to(tick); }
  const ramp::Tmc429& chip() const { return chip_; }

 private:
  void write(std::uint8_t number, std::int32_t value);
  void set_ramp_mode(ramp::Tmc429::Mode mode);

  std::span<const ParameterInfo> table_;
  ramp::Tmc429 chip_;
  std::array<std::int32_t, 256> values_{};
};

}  // namespace tmcl::sim

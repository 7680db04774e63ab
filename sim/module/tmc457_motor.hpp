/// The motor of a module with a TMC457.
#pragma once

#include "sim/module/chip_motor.hpp"
#include "tmcl/ramp/tmc457.hpp"

namespace tmcl::sim {

/// Parameters are registers as the application note "Motion Control Profile Parameterization" maps
/// them, and ROR, ROL, MST and MVP choose the mode. Not in any document at hand, and here as on
/// modules with a TMC429: parameter 8 compares the positions in any mode and even in passing, and a
/// relative movement counts from the actual position.
class Tmc457Motor final : public ChipMotor<ramp::Tmc457> {
 public:
  explicit Tmc457Motor(TimePoint power_on);

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;

  /// As far as the register goes, in the unit of the moment. Not limited by parameter 4.
  Status rotate(std::int64_t velocity) override;
  /// Slows down with parameters 17 and 18.
  void stop() override;
  /// Positions wrap at 32 bit.
  void move_to(std::int64_t position) override;
  std::int64_t top_speed() const override { return max_velocity_; }
  void limit_positioning(std::int64_t speed) override { chip().write(Register::v_max, speed); }
  std::int32_t relative_origin() const override { return position(); }

  std::int64_t speed() const override;
  void halt() override;

 private:
  std::optional<std::int32_t> chip_reading(std::uint8_t address) override;
  static std::span<const Mapped> mapped();
  bool reached() const { return position() == chip().read(Register::x_target); }
  std::int32_t status_flags() const;
  Status set_max_velocity(const ParameterInfo& row, std::int32_t value);

  std::int64_t max_velocity_ = 0;  // what V_MAX is, except in a positioning that is held back
};

}  // namespace tmcl::sim

/// A motor of a module with a TMC429.
#pragma once

#include "sim/module/chip_motor.hpp"
#include "tmcl/ramp/tmc429.hpp"

namespace tmcl::sim {

/// What the firmware does with the chip; behaviour measured on the vendor's open firmware of the
/// TMCM-1110, without its errors.
class Tmc429Motor final : public ChipMotor<ramp::Tmc429> {
 public:
  explicit Tmc429Motor(TimePoint power_on, const ModuleTraits& traits = {});

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;

  /// -2047..2047. Not limited by parameter 4, which the next positioning puts in force again.
  Status rotate(std::int64_t velocity) override;
  /// Slows down at the acceleration of parameter 5.
  void stop() override;
  /// Positions wrap at 24 bit.
  void move_to(std::int64_t position) override;
  std::int64_t top_speed() const override { return max_velocity_; }
  void limit_positioning(std::int64_t speed) override { chip().write(Register::v_max, speed); }
  std::int32_t relative_origin() const override { return chip().x_actual(); }

  std::int64_t speed() const override;
  void halt() override;

 private:
  std::optional<std::int32_t> chip_reading(std::uint8_t address) override;
  static std::span<const Mapped> mapped();
  void set_ramp_mode(ramp::Tmc429::Mode mode);

  std::int32_t max_velocity_ = 0;
};

}  // namespace tmcl::sim

/// A motor of a module with a TMC5130 or one of its relatives.
#pragma once

#include "sim/module/chip_motor.hpp"
#include "tmcl/ramp/sixpoint.hpp"

namespace tmcl::sim {

/// What the firmware does with the chip; behaviour read in the vendor's open firmware of the
/// TMC5130-HBS-KIT. The chip has no signed target velocity: to turn, the firmware writes VMAX and
/// the direction, and with the next positioning VMAX is again what parameter 4 says.
class SixPointMotor : public ChipMotor<ramp::SixPoint> {
 public:
  explicit SixPointMotor(TimePoint power_on);

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;

  /// As far as VMAX goes, in the unit of the moment. Not limited by parameter 4.
  Status rotate(std::int64_t velocity) override;
  /// Slows down at the acceleration of parameter 5.
  void stop() override;
  /// Positions wrap at 32 bit.
  void move_to(std::int64_t position) override;
  std::int64_t top_speed() const override { return max_velocity_; }
  void limit_positioning(std::int64_t speed) override { chip().write(Register::vmax, speed); }
  /// As parameter 127 says.
  std::int32_t relative_origin() const override;

  std::int64_t speed() const override;
  SwitchWiring wiring() const override { return wiring_; }
  void halt() override;

 protected:
  std::optional<std::int32_t> chip_reading(std::uint8_t address) override;
  SwitchWiring& wiring_to_set() { return wiring_; }
  void set_switch_mode(std::int32_t bits, bool on);

 private:
  static std::span<const Mapped> mapped();
  void set_mode(ramp::SixPoint::Mode mode);
  Status set_max_velocity(Scale scale, std::int32_t value);
  std::int32_t target_velocity(Scale scale) const;
  void wire_switches(std::uint8_t number, bool on);

  std::int64_t max_velocity_ = 0;  // what VMAX is while positioning
  bool relative_to_actual_ = false;
  SwitchWiring wiring_;
};

}  // namespace tmcl::sim

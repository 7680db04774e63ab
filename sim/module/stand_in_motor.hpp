/// A motor whose ramps are made by something that has no model here: the firmware, or a TMC4361
/// that drives trapezoids.
#pragma once

#include "sim/module/sixpoint_motor.hpp"
#include "tmcl/model.hpp"

namespace tmcl::sim {

/// A sixPoint chip stands in for it, with the same speeds, accelerations and edges of the ramp;
/// what goes beyond the chip's registers is set as far as these go, and reads as it was written.
/// Always counts in microsteps per second.
class StandInMotor final : public SixPointMotor {
 public:
  StandInMotor(const Model& model, TimePoint power_on);

  std::optional<std::int32_t> read(const ParameterInfo& row) const override;
  Status write(const ParameterInfo& row, std::int32_t value) override;
  Status rotate(std::int64_t velocity) override;

  std::int32_t target() const { return static_cast<std::int32_t>(chip().read(Register::xtarget)); }
  /// Stands there from now on, and calls that its target.
  void place(std::int32_t position, std::int32_t target);
  /// Which switches stop it, and whether it slows down at them.
  struct Stops {
    bool left;
    bool right;
    bool soft;
  };
  Stops stops() const;
  void enable_stops(Stops stops);
  /// How its chip is driven: the speed has a sign where it turns, and is in microsteps per second.
  struct Drive {
    bool to_target;
    std::int64_t velocity;
  };
  Drive drive() const;
  void drive(Drive drive);

 private:
  using Register = ramp::SixPoint::Register;
  struct Edge {
    std::uint8_t number;
    Register name;
  };

  static std::span<const Edge> edges(Family family);
  std::int64_t within(Register name, Scale scale, std::int64_t value) const;
  void set_edge(const ParameterInfo& row, std::int32_t value);
  void fill_gaps();
  void wire_switches(std::uint8_t number, bool on);

  Family family_;
  std::int32_t greatest_velocity_;
  // 0 on a TMC4361: as above the break velocity.
  std::int64_t start_acceleration_ = 0;
  std::int64_t final_deceleration_ = 0;
};

}  // namespace tmcl::sim

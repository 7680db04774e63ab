/// One axis on its line: which registers take it there in the line's time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/plan/line.hpp"

namespace tmcl::plan {

inline std::int64_t way_of(const LineAxis& axis) {
  return std::int64_t{axis.target.value} - axis.twin.motion().position.value;
}

class LineRunner {
 public:
  /// With the dividers that its module has, or with others. `part_of_longest`: of its way, in the
  /// longest one of the line.
  LineRunner(const LineAxis& axis, double part_of_longest,
             std::optional<Tmc429Dividers> dividers = std::nullopt);
  /// The same axis with each of the dividers that make its speed finer, the finest first; they have
  /// chosen their part of that ramp.
  static std::vector<LineRunner> finer(const LineAxis& axis, double part_of_longest,
                                       const SharedRamp& ramp);

  /// Its part of the common speed and acceleration. False if its registers cannot say that.
  bool choose(double velocity, double acceleration);
  /// The registers with which it takes nearest to this time.
  void fit(Duration wanted);
  /// It takes so much more or less than its part should that the others could not follow it.
  bool is_coarse() const;

  Duration arrival() const { return arrival_; }
  AxisOfLine result(Duration start) const;

 private:
  /// Values of parameters.
  struct Registers {
    std::int32_t velocity;      // max_velocity
    std::int32_t acceleration;  // max_acceleration
    std::int32_t minimum = 0;   // minimum_velocity of a TMC429; 0: the one that does not creep
  };

  ValueRange range(std::uint8_t parameter, double limit) const;
  std::vector<Setting> settings_to_write() const;
  std::vector<Setting> settings_of(Registers registers) const;
  AxisTwin run(Registers registers) const;
  bool take(Registers registers);
  bool try_out(Registers registers, Duration wanted);
  void keep_if_nearer(Registers registers, Duration arrival, Duration wanted);
  void creep_at_the_end(Registers registers, Duration wanted);
  double formula(Registers registers) const;
  std::vector<Registers> candidates(double time_s, std::size_t count) const;

  const LineAxis* axis_;
  std::optional<Tmc429Dividers> dividers_;
  AxisTwin standing_;
  double way_;
  double part_;
  double v_unit_;
  double a_unit_;
  ValueRange v_range_;
  ValueRange a_range_;
  double v_ideal_ = 0;
  double a_ideal_ = 0;
  Registers chosen_{};
  Duration arrival_{};
};

}  // namespace tmcl::plan

/// How the legs of a course are passed by ramp generators, and what it takes to load them.
#pragma once

#include <cmath>
#include <limits>

#include "motion/drive/stream_runner.hpp"

namespace tmcl::plan {

/// What an axis counts, of so many units; rounded up, and at least 1.
template <class Unit>
std::int32_t in_units(const StreamAxis& axis, double value, Unit unit,
                      std::int32_t most = std::numeric_limits<std::int32_t>::max()) {
  const double scale = std::abs(axis.microsteps_per_unit) / unit.value;
  return static_cast<std::int32_t>(std::clamp(std::ceil(value * scale - 1e-6), 1., 1. * most));
}
/// At least what a ramp generator can hold.
std::int32_t acceleration_in(const StreamAxis& axis, double value, std::int32_t most);

/// What each axis gets once more if ramps follow its joint: a check, its velocity, and what ramps
/// need.
inline constexpr std::size_t commands_after_joint = 5;

/// How a leg is passed.
struct Passage {
  enum class Drive : std::uint8_t { evenly, by_ramps, by_ramps_after_joint };
  CourseLeg leg;
  Drive drive;
  std::size_t index;
};

class RampLegs {
 public:
  /// All must outlive it; the report has the times of commands.
  RampLegs(const Course& course, const std::vector<StreamAxis>& axes, double even_within,
           const StreamReport& report)
      : joint_accelerations(axes.size()),
        course_(course),
        axes_(axes),
        even_within_(even_within),
        report_(report) {}

  Passage passage(std::size_t index) const;
  /// The velocities that the axes gain or lose where a leg begins.
  AxisValues changes_at(std::size_t index) const;
  /// What the joint before it may take of a leg, in seconds.
  static double longest_joint(const Passage& passage);
  /// With these accelerations of the axes, in their units.
  Duration time_of_joint(std::size_t index) const;
  std::vector<std::int32_t> joint_accelerations;
  std::size_t commands_of(std::size_t index) const;
  Duration lead_of(std::size_t index) const;
  /// How long before its begin a leg's load begins.
  Duration early_by(const Passage& passage) const;
  /// In the same sense on the next leg.
  bool goes_on(std::size_t index, std::size_t axis) const;
  bool must_turn(const Passage& passage, std::size_t axis) const;
  bool hardly_moves(const CourseLeg& leg, std::size_t axis) const;

 private:
  const Course& course_;
  const std::vector<StreamAxis>& axes_;
  double even_within_;
  const StreamReport& report_;
};

}  // namespace tmcl::plan

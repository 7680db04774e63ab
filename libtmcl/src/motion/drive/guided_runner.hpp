/// What streams of velocities share: axes guided by speeds, to targets where they have such.
#pragma once

#include <span>

#include "motion/drive/speed_ramp.hpp"
#include "motion/drive/stream_runner.hpp"

namespace tmcl::plan {

/// How a stream of velocities guides an axis: to targets, as fast as parameter 4 says in each
/// moment.
struct Guidance {
  bool by_targets = true;                       ///< Otherwise by ROR and ROL.
  std::span<const std::uint8_t> accelerations;  ///< Up and down; the first is that of ROR, too.
  std::uint8_t slowing;  ///< The one of these by which it goes down to a lower speed.
  std::span<const Setting> settings{};  ///< That go with it.
  Setting told{};             ///< What it reads on the way; as parameter 2, the greatest speed.
  std::int32_t farthest = 0;  ///< Target, in microsteps: others may be reached the other way round.
};
const Guidance& guidance_of(Family family);

class GuidedRunner : public StreamRunner {
 protected:
  using StreamRunner::StreamRunner;

  struct Guided {
    std::optional<std::int32_t> velocity;  ///< Of the last update.
    std::size_t stretch = 0;               ///< Which of the course's turns is next.
    std::int32_t target = 0;               ///< Where it is sent.
    SpeedRamp motion{};                    ///< What it should do by what it was told.
  };

  bool has_targets(std::size_t axis) const { return guidance_of(axes_[axis].family).by_targets; }
  Script<Fault> prepare_ramp(std::size_t axis);
  void set_pause_ramp();
  Script<Fault> set_out();
  /// `next_update`: of the course.
  Script<Fault> tell_velocity(std::size_t axis, std::int32_t velocity, double next_update);
  bool turn_is_due(std::size_t axis, std::int32_t velocity, double next_update) const;
  /// The course is at a halt, and no axis has been told to move.
  bool stands_at_halt() const;
  /// By what it was told, and by its target if it has one.
  SpeedRamp motion_at(std::size_t axis, TimePoint at) const;
  double expected(std::size_t axis, TimePoint at) const { return motion_at(axis, at).position; }
  double expected_speed(std::size_t axis, TimePoint at) const { return motion_at(axis, at).speed; }
  void correct(std::size_t axis);
  /// In microsteps per second squared.
  double acceleration_of(std::size_t axis, std::int32_t value) const;
  double acceleration_now(std::size_t axis, std::uint8_t parameter) const;
  /// What the course does not need of an acceleration, in microsteps per second squared.
  double left_by_course(std::size_t axis, double acceleration) const;
  static std::int32_t greatest_acceleration_of(const StreamAxis& axis);

  std::vector<Guided> guided_ = std::vector<Guided>(axes());

 private:
  Script<Fault> set_out(std::size_t axis);
  Script<Fault> guide(std::size_t axis, std::int32_t velocity, double next_update);
  bool turn(std::size_t axis, std::int32_t velocity, double next_update);
  bool stops_in_time(std::size_t axis) const;
  int heading(std::size_t axis) const;
  std::int32_t target_from(std::size_t axis, double position) const;
  void note_velocity(std::size_t axis, std::int32_t velocity, TimePoint at);
};

}  // namespace tmcl::plan

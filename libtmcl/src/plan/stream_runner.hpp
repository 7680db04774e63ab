/// What is behind a PathStream.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "plan/drive_runner.hpp"
#include "tmcl/plan/stream.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {

inline Duration duration(double seconds) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// How much of the course has been passed; may go slower than time, down to a standstill and up
/// again.
class CourseClock {
 public:
  void start(TimePoint now, bool stands);
  void set_ramp(double seconds) { ramp_s_ = seconds; }
  void pause(bool on) { paused_ = on; }
  bool paused() const { return paused_; }
  void advance(TimePoint now);
  double passed() const { return passed_; }
  /// So much later than the last advance().
  double passed_in(Duration ahead) const;

 private:
  double passed_after(double time, double& rate) const;

  TimePoint at_{};
  double passed_ = 0;
  double rate_ = 1;
  double ramp_s_ = 0;
  bool paused_ = false;
};

/// How a stream of velocities guides an axis: to targets, as fast as parameter 4 says in each
/// moment.
struct Guidance {
  bool by_targets = true;                       ///< Otherwise by ROR and ROL.
  std::span<const std::uint8_t> accelerations;  ///< Up and down; the first is that of ROR, too.
  std::span<const Setting> settings{};          ///< That go with it.
  Setting told{};             ///< What it reads on the way; as parameter 2, the greatest speed.
  std::int32_t farthest = 0;  ///< Target, in microsteps: others may be reached the other way round.
};
const Guidance& guidance_of(Family family);

/// A long course is not looked at all at once, which would take seconds: whoever runs the stream is
/// waited for after so many legs, or points.
constexpr std::size_t looks_at_once = 1000;
constexpr bool takes_a_breath(std::size_t look) {
  return look % looks_at_once == looks_at_once - 1;
}

class PathStream::Runner final : public DriveRunner {
 public:
  Runner(const Course& course, std::vector<StreamAxis> axes, StreamOptions options);

  void pause(bool on) {
    pause_asked_ = on;
    if (options_.mode == StreamMode::velocity) clock_.pause(on);
    if (phase_ == Phase::running && on) phase_ = Phase::pausing;
    if (phase_ == Phase::pausing && !on) phase_ = Phase::running;
  }
  Phase phase() const { return phase_; }
  double passed() const { return std::min(clock_.passed(), course_.duration()); }
  const StreamReport& report() const { return report_; }

 private:
  struct Axis {
    StreamAxis info;
    // What a parameter reads as long as nobody else stops or turns it.
    std::optional<Setting> told;
    std::optional<std::int32_t> velocity;  // in velocity mode, of the last update
    std::size_t stretch = 0;               // in velocity mode: which of the course's turns is next
    std::int32_t target = 0;               // in velocity mode: where it is sent
    // Velocity mode: where it should be by what it was told, in microsteps, and when that was.
    // Position mode: how far it is ahead of its twin.
    double position = 0;
    double pps = 0;
    TimePoint at{};
    TimePoint due{};
    double steepest = 0;    // in velocity mode, between updates; in units a second squared
    Duration twin_begin{};  // what its twin counted at twin_start_
    std::int32_t joint_acceleration = 0;  // position mode
  };

  std::int32_t microsteps(std::size_t axis, double position) const;

  Script<Fault> whole() override;
  void on_answered(Duration took) override;
  Script<Fault> measure();
  Script<Fault> arrive_at_end();
  Script<Fault> go_to(AxisValues position, TimePoint limit);
  void on_written(std::size_t axis, Setting setting) override;
  Script<Fault> check(std::size_t axis);
  Script<Fault> check_all();
  Script<Fault> read_position(std::size_t axis);
  double planned_position(std::size_t axis) const;
  Fault take_reading(std::size_t axis);
  Fault note_delay(Duration late, Duration period);

  // Velocity mode.
  Script<Fault> prepare_velocities();
  Script<Fault> by_velocity();
  Script<Fault> update(std::size_t axis);
  std::int32_t velocity_for(std::size_t axis) const;
  double expected(std::size_t axis, TimePoint at) const;
  void note_velocity(std::size_t axis, std::int32_t velocity, TimePoint at);
  void correct(std::size_t axis);
  Script<Fault> find_steepest();
  Script<Fault> raise_accelerations(std::size_t axis);
  double acceleration_of(std::size_t axis, std::int32_t value) const;
  void set_pause_ramp();

  // Velocity mode, by targets.
  bool has_targets(std::size_t axis) const {
    return guidance_of(axes_[axis].info.family).by_targets;
  }
  Script<Fault> prepare_targets(std::size_t axis);
  Script<Fault> set_out(std::size_t axis);
  Script<Fault> guide(std::size_t axis, std::int32_t velocity);
  bool turn(std::size_t axis, std::int32_t velocity);
  int heading(std::size_t axis) const;
  std::int32_t target_from(std::size_t axis, double position) const;

  // Position mode.
  /// How a leg is passed.
  enum class Drive : std::uint8_t { evenly, by_ramps, by_ramps_after_joint };
  struct Passage {
    CourseLeg leg;
    Drive drive;
    std::size_t index;
  };
  struct Ramps {
    std::int32_t amax, dmax, vstop;
  };
  Script<Fault> prepare_legs();
  Script<Fault> by_position();
  Script<Fault> start_ramps();
  Script<Fault> pause_between(const CourseLeg& next);
  Script<Fault> watch_until(TimePoint due);
  bool hardly_moves(const CourseLeg& leg, std::size_t axis) const;
  bool must_turn(const Passage& passage, std::size_t axis) const;
  double target_of(const Passage& passage, std::size_t axis) const;
  bool leads_on(const CourseLeg& leg, const CourseLeg& next, std::size_t axis) const;
  Script<Fault> load(const Passage& passage);
  Script<Fault> load_axis(const Passage& passage, std::size_t axis);
  Script<Fault> load_ramps(const Passage& passage);
  Script<Fault> set_velocity(std::size_t axis, std::int32_t value);
  Script<Fault> set_braking(std::size_t axis, Ramps ramps);
  Passage passage(std::size_t index) const;
  AxisValues changes_at(std::size_t index) const;
  Script<Fault> set_joint_accelerations();
  static double longest_joint(const Passage& passage);
  Duration time_of_joint(std::size_t index) const;
  Fault fault_of_axes() const;
  Script<Fault> fit_legs_to_bus();
  std::size_t commands_of(std::size_t leg) const;
  double pace(const Passage& passage, double speed, std::size_t axis);
  std::int32_t velocity_in(const Passage& passage, double speed, std::size_t axis);
  Ramps no_ramps(std::size_t axis) const;
  Ramps ramps_for(const Passage& passage, std::size_t axis);
  template <class Unit>
  std::int32_t in_units(std::size_t axis, double value, Unit unit,
                        std::int32_t most = std::numeric_limits<std::int32_t>::max()) const {
    const double scale = std::abs(axes_[axis].info.microsteps_per_unit) / unit.value;
    return static_cast<std::int32_t>(std::clamp(std::ceil(value * scale - 1e-6), 1., 1. * most));
  }
  std::int32_t acceleration_in(std::size_t axis, double value, std::int32_t most) const;
  double time_to_send(std::size_t commands) const;
  Duration lead_of(std::size_t leg) const;
  Duration ahead_of(std::size_t leg) const;
  Duration early_by(const Passage& passage) const;
  double expected_of_twin(std::size_t axis) const;
  void correct_twin(std::size_t axis);
  void let_twin_run(std::size_t axis, TimePoint to);

  const Course& course_;
  StreamOptions options_;
  std::vector<Axis> axes_;
  StreamReport report_;
  TimePoint twin_start_{};
  std::size_t watched_ = 0;            // position mode: the axis that is looked at next
  std::optional<CourseLeg> even_leg_;  // position mode: the one that is passed evenly
  CourseClock clock_;
  bool pause_asked_ = false;
  Phase phase_ = Phase::before;
};

}  // namespace tmcl::plan

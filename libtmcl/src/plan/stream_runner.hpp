/// What is behind a PathStream.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "plan/drive_runner.hpp"
#include "plan/speed_ramp.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/stream.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan {

/// The axis parameter of the chips that slow down by another acceleration than they speed up by.
inline constexpr auto dmax = number_of("max_deceleration");

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
  /// At full rate, from where the course stood.
  void go_on(TimePoint now, double passed) {
    at_ = now;
    passed_ = passed;
    rate_ = 1;
    paused_ = false;
  }
  void advance(TimePoint now);
  double passed() const { return passed_; }
  /// So much later than the last advance().
  double passed_in(Duration ahead) const;
  double passed_at(TimePoint time) const { return passed_in(time - at_); }
  /// Neither paused, nor on the way into a pause or out of one.
  bool is_at_full_rate() const { return !paused_ && rate_ == 1; }

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
  std::uint8_t slowing;  ///< The one of these by which it goes down to a lower speed.
  std::span<const Setting> settings{};  ///< That go with it.
  Setting told{};             ///< What it reads on the way; as parameter 2, the greatest speed.
  std::int32_t farthest = 0;  ///< Target, in microsteps: others may be reached the other way round.
};
const Guidance& guidance_of(Family family);

/// The times at which the speed of an axis bends: where a leg begins, where it begins to slow down,
/// and where the course comes to a stand.
class CourseBends {
 public:
  /// After a joint at which speeds jump and then grow, there is a bend so much later.
  CourseBends(const Course& course, double joint_s) : course_(&course), joint_s_(joint_s) {}
  /// The first one that is not before `time`; after the last one, the end. No time may be before
  /// that of the call before.
  double not_before(double time);
  /// Whether the speed of an axis changes at once there.
  bool jumps_at(double time) const;

 private:
  const Course* course_;
  double joint_s_;
  std::size_t leg_ = 0;
};

/// On a leg, and between its loads, an axis is looked at so often.
constexpr Duration watch_interval = std::chrono::milliseconds(20);

/// A long course is not looked at all at once, which would take seconds: the stream's runner is
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
    if (options_.mode != StreamMode::position) clock_.pause(on);
    if (phase_ == Phase::running && on) phase_ = Phase::pausing;
    if (phase_ == Phase::pausing && !on) phase_ = Phase::running;
  }
  Phase phase() const { return phase_; }
  double passed() const { return std::min(clock_.passed(), course_.duration()); }
  const StreamReport& report() const { return report_; }

 private:
  struct Axis {
    StreamAxis info;
    // What a parameter reads unless another client stops or turns it.
    std::optional<Setting> told;
    std::optional<std::int32_t> velocity;   // in velocity mode, of the last update
    int place = 0;                          // by segments: in the order in which the axes are told
    std::optional<TimePoint> brought_back;  // by segments: where it should be, by then
    std::size_t stretch = 0;                // in velocity mode: which of the course's turns is next
    std::int32_t target = 0;                // in velocity mode: where it is sent
    SpeedRamp motion{};  // in velocity mode: what it should do by what it was told
    TimePoint due{};
    double steepest = 0;       // in velocity mode, between updates; in units a second squared
    double ahead_of_twin = 0;  // position mode, in microsteps
    Duration twin_begin{};     // what its twin counted at twin_start_
    std::int32_t joint_acceleration = 0;  // position mode
  };

  std::int32_t microsteps(std::size_t axis, double position) const;

  Script<Fault> whole() override;
  void on_answered(Duration took) override;
  Script<Fault> measure();
  Script<Fault> prepare();
  Script<Fault> pass_course();
  Script<Fault> arrive_at_end();
  Script<Fault> go_to(AxisValues position, TimePoint limit);
  void on_written(std::size_t axis, Setting setting) override;
  Script<Fault> check(std::size_t axis);
  Script<Fault> check_all();
  Script<Fault> read_position(std::size_t axis);
  double planned_position(std::size_t axis) const;
  Fault take_reading(std::size_t axis);
  void note_place_on_path();
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
  static std::int32_t greatest_acceleration_of(const StreamAxis& axis);
  void set_pause_ramp();

  Script<Fault> set_out();
  Script<Fault> tell_velocity(std::size_t axis, std::int32_t velocity, double next_update);

  // Velocity mode, by segments.
  /// For how long the axes keep what they are told, and where they are to be then.
  struct SegmentSpan {
    TimePoint begin;
    TimePoint end;
    double course_end;
    PathState at_end;
    bool smooth;     ///< The course has no joint there.
    Duration early;  ///< How long before its begin it is told, for half of the jump there.
    bool full_rate;
  };
  Script<Fault> prepare_segments();
  Script<Fault> by_segments();
  Script<Fault> end_by_targets();
  SegmentSpan span_from(TimePoint begin);
  SegmentSpan span_of_course(TimePoint begin);
  SegmentSpan span_of_pause(TimePoint begin) const;
  Script<Fault> pass_segment(const SegmentSpan& span);
  Script<Fault> tell_segment(std::size_t axis, const SegmentSpan& span);
  Script<Fault> set_slopes(std::size_t axis, double speed, double slope, double braking);
  Script<Fault> set_slope(std::size_t axis, std::uint8_t parameter, double slope);
  Script<Fault> watch_segment(const SegmentSpan& span, TimePoint until_time);
  std::vector<std::size_t> order_of(const SegmentSpan& span);
  Script<Fault> turn_late_ones(const SegmentSpan& span);
  Script<Fault> bring_back(std::size_t axis, const SegmentSpan& span);
  Script<Fault> end_corrections(const SegmentSpan& span);
  Script<Fault> tell_rest(std::size_t axis, const SegmentSpan& span);
  SegmentTask task_of(std::size_t axis, const SegmentSpan& span) const;
  double speed_for(std::size_t axis, const SegmentTask& task, const Segment& wanted) const;
  double slope_now(std::size_t axis, double speed) const;
  double braking_needed(std::size_t axis, const SegmentSpan& span, double speed) const;
  double own_slope(std::size_t axis) const;
  double least_slope(std::size_t axis, const SegmentSpan& span, double speed) const;
  double greatest_slope(std::size_t axis, bool smooth) const;
  TimePoint told_at(std::size_t axis, const SegmentSpan& span) const;

  // Velocity mode, by targets.
  bool has_targets(std::size_t axis) const {
    return guidance_of(axes_[axis].info.family).by_targets;
  }
  Script<Fault> prepare_ramp(std::size_t axis);
  Script<Fault> set_out(std::size_t axis);
  /// `next_update`: of the course.
  Script<Fault> guide(std::size_t axis, std::int32_t velocity, double next_update);
  bool turn(std::size_t axis, std::int32_t velocity, double next_update);
  bool stops_in_time(std::size_t axis) const;
  bool turn_is_due(std::size_t axis, std::int32_t velocity, double next_update) const;
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
  /// How an axis comes to a leg, and so what of it may be written when.
  enum class Way : std::uint8_t {
    goes_on,       ///< At its speed: the next one is what it changes at the joint.
    goes_on_late,  ///< Its speed still changes when the load begins.
    brakes,        ///< Until its target is replaced.
    from_rest,     ///< Its target sets it off.
    turns,         ///< It is sent back when it stands at the joint.
  };
  struct Load {
    std::size_t axis;
    Way way;
    std::int32_t amax, dmax, vstop, target;
  };
  Script<Fault> prepare_legs();
  Script<Fault> by_position();
  Script<Fault> start_ramps();
  Script<Fault> pause_between(const CourseLeg& next);
  Script<Fault> watch_until(TimePoint due);
  bool hardly_moves(const CourseLeg& leg, std::size_t axis) const;
  bool must_turn(const Passage& passage, std::size_t axis) const;
  Script<Fault> begin_from_rest(const Passage& passage);
  Script<Fault> begin_on_the_way(const Passage& passage);
  TimePoint time_at_joint(const Passage& passage);
  Script<Fault> see_standing(const Passage& passage);
  Script<Fault> see_standing(std::size_t axis);
  Script<Fault> see_joint_speeds(const Passage& passage);
  bool has_slowed_down(std::size_t axis) const;
  Script<Fault> prepare_loads(const Passage& passage);
  Script<Fault> write_before(const Passage& passage, const Load& load);
  Script<Fault> begin_leg(const Passage& passage);
  Script<Fault> load_ramps(const Passage& passage);
  Script<Fault> set_start_speed(const Passage& passage, std::size_t axis);
  Script<Fault> set_velocity(const Passage& passage, double speed, std::size_t axis);
  Script<Fault> set_target(const Load& load);
  Script<Fault> set_deceleration(const Passage& passage, const Load& load);
  Script<Fault> set_braking(const Passage& passage, const Load& load);
  Way way_to(const Passage& passage, std::size_t axis) const;
  bool goes_on(std::size_t index, std::size_t axis) const;
  Load load_for(const Passage& passage, std::size_t axis);
  void aim(const Passage& passage, Load& load) const;
  std::int32_t own_acceleration(std::size_t axis) const;
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
  template <class Unit>
  std::int32_t in_units(std::size_t axis, double value, Unit unit,
                        std::int32_t most = std::numeric_limits<std::int32_t>::max()) const {
    const double scale = std::abs(axes_[axis].info.microsteps_per_unit) / unit.value;
    return static_cast<std::int32_t>(std::clamp(std::ceil(value * scale - 1e-6), 1., 1. * most));
  }
  std::int32_t acceleration_in(std::size_t axis, double value, std::int32_t most) const;
  double time_to_send(std::size_t commands) const;
  Duration lead_of(std::size_t leg) const;
  Duration early_by(const Passage& passage) const;
  TimePoint time_of(double course_time);
  double expected_of_twin(std::size_t axis) const;
  void correct_twin(std::size_t axis);
  void let_twin_run(std::size_t axis, TimePoint to);

  const Course& course_;
  StreamOptions options_;
  std::vector<Axis> axes_;
  StreamReport report_;
  AxisValues off_plan_{};  // of each axis, as it was read last
  TimePoint twin_start_{};
  std::size_t watched_ = 0;            // the axis that is looked at next
  std::vector<Load> loads_;            // position mode: of the leg that begins
  std::optional<CourseLeg> even_leg_;  // position mode: the one that is passed evenly
  CourseClock clock_;
  CourseBends bends_{course_, 0};
  bool pause_asked_ = false;
  Phase phase_ = Phase::before;
};

}  // namespace tmcl::plan

/// How much of a course has been passed: its time may go slower and faster than that of the world.
#pragma once

#include <span>

#include "motion/drive/course_pace.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::plan {

/// The rate of a course's time is brought to what is asked for as fast as the axes can; down to a
/// standstill in a pause, and up again. A dwell takes its time at any rate but in a pause. At a
/// halt of the course it stands until it is let go on.
class CourseClock {
 public:
  /// `course` must outlive it.
  explicit CourseClock(const Course& course)
      : course_(&course), pace_(course), halts_left_(course.halts()) {}

  void start(TimePoint now, bool stands);
  /// How long it takes from a standstill to what was planned, at least; 0: no time.
  void set_ramp(double seconds) { ramp_s_ = seconds; }
  void pause(bool on) { paused_ = on; }
  bool paused() const { return paused_; }
  /// The rate that is asked for, unless it is paused.
  void set_factor(double factor) { factor_ = factor; }
  double factor() const { return factor_; }
  double rate() const { return rate_; }
  /// As it was planned, from where the course stood.
  void go_on(TimePoint now, double passed) {
    at_ = now;
    passed_ = passed;
    rate_ = 1;
    paused_ = false;
  }
  void advance(TimePoint now);
  double passed() const { return passed_; }
  /// At which it stands, if it does.
  const CourseHalt* halt() const { return is_at_halt(passed_) ? next_halt() : nullptr; }
  /// The first that it has not left; null behind the last one.
  const CourseHalt* next_halt() const { return halts_left_.empty() ? nullptr : halts_left_.data(); }
  /// Whether it stands at one then, unless it is let go on before.
  bool is_at_halt_at(TimePoint time) const { return is_at_halt(passed_at(time)); }
  /// Lets it go on from then on.
  void leave_halt(TimePoint begin) {
    at_ = begin;
    halts_left_ = halts_left_.subspan(1);
  }
  /// Whether all is passed, and done.
  bool is_over() const { return passed_ >= course_->duration() && halts_left_.empty(); }
  /// So much later than the last advance().
  double passed_in(Duration ahead) const;
  double passed_at(TimePoint time) const { return passed_in(time - at_); }
  /// Neither stands, nor has a rate that changes, or that may have to change on the way.
  bool is_steady() const { return !paused_ && rate_ == factor_ && rate_ <= 1 && !halt(); }
  /// How long it takes from one time of the course to another one, while it is steady.
  double time_between(double from, double to) const;

 private:
  /// What is nearer than this is rounding, in seconds.
  static constexpr double at_halt = 1e-9;

  double goal() const { return paused_ ? 0 : factor_; }
  bool is_at_halt(double passed) const {
    return !halts_left_.empty() && passed >= halts_left_.front().time - at_halt;
  }
  double passed_after(double time, double& rate) const;
  double bound_after(const std::optional<CourseRest>& rest, bool rests) const;
  double changed(double passed, double rate, double time) const;

  const Course* course_;
  CoursePace pace_;
  std::span<const CourseHalt> halts_left_;
  TimePoint at_{};
  double passed_ = 0;
  double rate_ = 1;
  double factor_ = 1;
  double ramp_s_ = 0;
  bool paused_ = false;
};

}  // namespace tmcl::plan

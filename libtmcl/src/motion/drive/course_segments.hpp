/// The segments of a course: for how long an axis may keep one change of its speed.
#pragma once

#include "motion/drive/stream_runner.hpp"

namespace tmcl::plan {

/// Just before and after a joint, in seconds.
inline constexpr double instant = 1e-9;
/// A joint is where a speed jumps by more than this part of the greatest one.
inline constexpr double jump_part = 0.02;
/// The least part of an update that a change of speed takes, where the course has a joint.
inline constexpr double shortest_segment_ramp = 0.5;

/// The times at which the speed of an axis bends: where a leg begins, where it begins to slow down,
/// where the course comes to a stand,
/// and with a jerk where an acceleration has changed for a while.
class CourseBends {
 public:
  /// After a joint at which speeds jump and then grow, there is a bend so much later.
  CourseBends(const Course& course, double joint_s);
  /// The first one that is not before `time`; after the last one, the end. No time may be before
  /// that of the call before.
  double not_before(double time);
  /// Whether the speed of an axis changes at once there.
  bool jumps_at(double time) const;

 private:
  /// Of a shaped course one for each of its impulses; otherwise one that is not delayed.
  struct Part {
    double delay = 0;
    std::size_t leg = 0;
  };
  double not_before(double time, Part& part) const;
  double leg_not_before(double time, Part& part) const;

  const Course* course_;
  double joint_s_;
  std::vector<Part> parts_;
};

/// For how long the axes keep what they are told, and where they are to be then.
struct SegmentSpan {
  TimePoint begin;
  TimePoint end;
  double course_end;
  PathState at_end;
  bool smooth;     ///< The course has no joint there.
  Duration early;  ///< How long before its begin it is told, for half of the jump there.
  bool steady;     ///< Time on the course goes evenly meanwhile.
  double rate;     ///< By so much.
  /// Otherwise its end is another one by now.
  bool goes_with(const CourseClock& clock) const {
    return steady ? clock.is_steady() && clock.rate() == rate : !clock.is_steady();
  }
};

/// A state of the course if its time goes by so much.
PathState at_rate(double rate, PathState state);

class CourseSegments {
 public:
  /// Both must outlive it. `period`: between updates, at least.
  CourseSegments(const Course& course, const CourseClock& clock, Duration period)
      : course_(course), clock_(clock), period_(period), bends_(course, seconds(period)) {}
  SegmentSpan from(TimePoint begin);

 private:
  SegmentSpan of_course(TimePoint begin);
  SegmentSpan of_change(TimePoint begin) const;

  const Course& course_;
  const CourseClock& clock_;
  Duration period_;
  CourseBends bends_;
};

}  // namespace tmcl::plan

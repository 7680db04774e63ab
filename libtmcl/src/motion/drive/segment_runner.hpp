/// A stream of velocities that tells an axis as little as a course has segments.
#pragma once

#include "motion/drive/course_segments.hpp"
#include "motion/drive/guided_runner.hpp"

namespace tmcl::plan {

/// In so many updates an axis is back where it should be.
inline constexpr int updates_of_a_correction = 6;

class SegmentRunner final : public GuidedRunner {
 public:
  using GuidedRunner::GuidedRunner;

 private:
  Script<Fault> prepare() override;
  Script<Fault> pass_course() override;
  Script<Fault> end_by_targets();
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
  static bool may_stand(const SegmentTask& task, const SegmentSpan& span);
  SegmentTask task_of(std::size_t axis, const SegmentSpan& span) const;
  double speed_for(std::size_t axis, const SegmentSpan& span, const SegmentTask& task,
                   const Segment& wanted) const;
  double without_overtaking(std::size_t axis, const SegmentTask& task, double speed) const;
  bool turns(std::size_t axis, double speed) const;
  double slope_now(std::size_t axis, double speed) const;
  double braking_needed(std::size_t axis, const SegmentSpan& span, double speed) const;
  Fault objection_to_slope(std::size_t axis) const;
  double own_slope(std::size_t axis) const;
  double least_slope(std::size_t axis, const SegmentSpan& span, double speed) const;
  double greatest_slope(std::size_t axis, bool smooth) const;
  TimePoint told_at(std::size_t axis, const SegmentSpan& span) const;

  std::optional<CourseSegments> segments_;  // once the period is known
  // In the order in which the axes are told.
  std::vector<int> place_ = std::vector<int>(axes());
  // By then an axis is where it should be.
  std::vector<std::optional<TimePoint>> brought_back_{axes()};
};

}  // namespace tmcl::plan

// A course that is the mean of itself at several times.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "tmcl/plan/course.hpp"

namespace tmcl::plan {
namespace {

/// Just before and after a time at which a speed may jump, in seconds.
constexpr double just_beside = 1e-9;
/// A speed that is less than this part of the greatest one is none: sums are rounded.
constexpr double standing_part = 1e-9;
/// Between two rows of a table a speed is a parabola, which is looked at so often.
constexpr int looks_between_rows = 4;
/// A time at which an axis turns is found to the last bits in so many halvings.
constexpr int halvings = 50;

/// The bends of a course in each of its parts, ascending.
class ShiftedBends {
 public:
  ShiftedBends(const std::vector<double>& bends, const std::vector<Impulse>& impulses)
      : bends_(bends), impulses_(impulses) {
    for (std::size_t part = 0; part < impulses.size(); ++part) offer(part, 0);
  }
  std::optional<double> next() {
    if (soonest_.empty()) return std::nullopt;
    const auto [time, part, index] = soonest_.top();
    soonest_.pop();
    offer(part, index + 1);
    return time;
  }

 private:
  struct Bend {
    double time;
    std::size_t part;
    std::size_t index;
    bool operator>(const Bend& other) const { return time > other.time; }
  };
  void offer(std::size_t part, std::size_t index) {
    if (index < bends_.size()) soonest_.push({bends_[index] + impulses_[part].delay, part, index});
  }

  const std::vector<double>& bends_;
  const std::vector<Impulse>& impulses_;
  std::priority_queue<Bend, std::vector<Bend>, std::greater<>> soonest_;
};

}  // namespace

PathState Course::at(double t) const {
  if (impulses_.empty()) return plain_at(t);
  PathState sum;
  for (const auto& [delay, part] : impulses_) {
    const auto state = plain_at(t - delay);
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      sum.position[axis] += part * state.position[axis];
      sum.velocity[axis] += part * state.velocity[axis];
    }
  }
  return sum;
}

PathMotion Course::motion_at(double t) const {
  if (impulses_.empty()) return plain_motion_at(t);
  PathMotion sum{at(t)};
  for (const auto& [delay, part] : impulses_) {
    const auto motion = plain_motion_at(t - delay);
    for (std::size_t axis = 0; axis < axes_; ++axis) {
      sum.acceleration[axis] += part * motion.acceleration[axis];
      sum.jerk[axis] += part * motion.jerk[axis];
    }
  }
  return sum;
}

PathState Course::unshaped_at(double t) const { return plain_at(t - mean_delay(impulses_)); }

std::vector<double> Course::plain_bends() const {
  std::vector<double> bends;
  for (const auto& piece : pieces_) {
    bends.push_back(piece.begin);
    if (const auto* plan = std::get_if<PathPlan>(&piece.what)) {
      const auto first = static_cast<std::ptrdiff_t>(bends.size());
      for (const auto& leg : plan->legs()) {
        const double begin = piece.begin + leg.begin;
        bends.insert(bends.end(),
                     {begin + leg.up, begin + leg.up + leg.even, piece.begin + leg.end()});
      }
      const auto middle = static_cast<std::ptrdiff_t>(bends.size());
      for (double t = 0; std::isfinite(t = plan->bend_not_before(t)); t += 2 * just_beside)
        bends.push_back(piece.begin + t);
      std::inplace_merge(bends.begin() + first, bends.begin() + middle, bends.end());
    } else if (const auto* rows = std::get_if<Timetable>(&piece.what)) {
      for (std::size_t row = 0; row + 1 < rows->size(); ++row) {
        for (int look = 1; look <= looks_between_rows; ++look)
          bends.push_back(piece.begin + std::lerp((*rows)[row].time, (*rows)[row + 1].time,
                                                  static_cast<double>(look) / looks_between_rows));
      }
    }
  }
  return bends;
}

/// Finds where the axes of a shaped course turn round, and how fast they get.
class Course::Shaped {
 public:
  explicit Shaped(Course& course) : course_(course) {
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      slowest_[axis] = standing_part * course_.top_speed_[axis];
      course_.turns_[axis].clear();
      // Of a table it stays what the parabolas of the plain one reach.
      if (!course_.timed_) course_.top_speed_[axis] = 0;
    }
  }

  void look_between(double begin, double end) {
    const auto first = course_.at(begin + just_beside).velocity;
    const auto last = course_.at(end - just_beside).velocity;
    for (std::size_t axis = 0; axis < course_.axes_; ++axis) {
      auto& top = course_.top_speed_[axis];
      top = std::max({top, std::abs(first[axis]), std::abs(last[axis])});
      heads(axis, first[axis], begin);
      const bool turns = first[axis] * last[axis] < 0;
      heads(axis, last[axis], turns ? turn_between(axis, begin, end) : begin);
    }
  }

  void finish() {
    const double end = course_.duration();
    const auto place = course_.at(end).position;
    for (std::size_t axis = 0; axis < course_.axes_; ++axis)
      course_.turns_[axis].push_back({end, place[axis]});
  }

 private:
  /// From `time` on it has this velocity.
  void heads(std::size_t axis, double velocity, double time) {
    if (std::abs(velocity) <= slowest_[axis]) return;
    if (velocity * heading_[axis] < 0)
      course_.turns_[axis].push_back({time, course_.at(time).position[axis]});
    heading_[axis] = velocity;
  }

  double turn_between(std::size_t axis, double begin, double end) const {
    const double before = course_.at(begin + just_beside).velocity[axis];
    for (int halving = 0; halving < halvings; ++halving) {
      const double middle = std::midpoint(begin, end);
      (course_.at(middle).velocity[axis] * before > 0 ? begin : end) = middle;
    }
    return std::midpoint(begin, end);
  }

  Course& course_;
  AxisValues slowest_{};
  AxisValues heading_{};
};

void Course::shape(const Shaping& shaping) {
  impulses_ = impulses_of(shaping);
  const auto bends = plain_bends();
  ShiftedBends shifted(bends, impulses_);
  Shaped shaped(*this);
  double before = 0;
  while (const auto bend = shifted.next()) {
    if (*bend - before <= 2 * just_beside) continue;
    shaped.look_between(before, *bend);
    before = *bend;
  }
  shaped.finish();
}

}  // namespace tmcl::plan

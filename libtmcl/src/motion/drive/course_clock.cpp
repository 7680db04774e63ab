#include "motion/drive/course_clock.hpp"

#include <algorithm>
#include <limits>

#include "tmcl/seconds.hpp"

namespace tmcl::plan {
namespace {

// For so long a rate is taken to change evenly.
constexpr double step_of_change_s = 0.001;

}  // namespace

void CourseClock::start(TimePoint now, bool stands) {
  at_ = now;
  rate_ = stands || paused_ ? 0 : std::min(factor_, 1.0);
}

void CourseClock::advance(TimePoint now) {
  const double time = seconds(now - at_);
  at_ = std::max(at_, now);
  if (time > 0) passed_ = passed_after(time, rate_);
}

double CourseClock::passed_in(Duration ahead) const {
  double rate = rate_;
  return passed_after(seconds(ahead), rate);
}

double CourseClock::passed_after(double time, double& rate) const {
  double passed = passed_;
  if (time < 0) return passed + rate * time;
  if (ramp_s_ == 0) rate = goal();
  while (time > 0) {
    const auto rest = course_->rest_after(passed);
    const bool halts = is_at_halt(passed);
    const bool rests = halts || (rest && rest->begin <= passed);
    if (rests) rate = std::min(goal(), 1.0);
    if (halts || (rate == 0 && goal() == 0)) return passed;
    const bool steady = rests || (rate == goal() && rate <= 1);
    const double step = steady ? time : std::min(time, step_of_change_s);
    const double next = steady ? rate : changed(passed, rate, step);
    const double way = rests ? step : (rate + next) / 2 * step;
    const double bound = bound_after(rest, rests);
    if (passed + way >= bound) {
      // What comes next is looked at anew.
      time -= step * (bound - passed) / way;
      passed = bound;
    } else {
      time -= step;
      passed += way;
    }
    rate = next;
  }
  return passed;
}

// How far the course goes on as it does now.
double CourseClock::bound_after(const std::optional<CourseRest>& rest, bool rests) const {
  double bound = std::numeric_limits<double>::infinity();
  if (rest) bound = rests ? rest->end : rest->begin;
  return halts_left_.empty() ? bound : std::min(bound, halts_left_.front().time);
}

// After so much more time, in which a ramp of the course may begin: it has the rate for it before.
double CourseClock::changed(double passed, double rate, double time) const {
  const double slope = 1 / ramp_s_;
  const double then = passed + rate * time;
  const double wanted = pace_.most_rate(then + rate * time, slope, goal());
  const auto here = pace_.changes(passed, rate), there = pace_.changes(then, rate);
  const double change =
      std::clamp(wanted - rate, time * std::max({here.least, there.least, -slope}),
                 time * std::min({here.most, there.most, slope}));
  return change == wanted - rate ? wanted : std::max(rate + change, 0.0);
}

double CourseClock::time_between(double from, double to) const {
  double time = 0;
  while (from < to) {
    const auto rest = course_->rest_after(from);
    const bool rests = rest && rest->begin <= from;
    const double next = std::min(to, rests ? rest->end : rest ? rest->begin : to);
    time += (next - from) / (rests ? 1 : rate_);
    from = next;
  }
  return time;
}

}  // namespace tmcl::plan

#include "plot/comparison.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "axis/quantity_text.hpp"

namespace tmclctl::plot {
namespace {

constexpr double plan_step_s = 0.0005;
constexpr int starts_tried = 200;

/// The positions of a plan, evenly over time, for any time in between.
class Track {
 public:
  Track(const tmcl::plan::AxisTwin& twin, double duration_s) {
    using namespace std::chrono;
    const auto step = duration_cast<tmcl::Duration>(duration<double>(plan_step_s));
    // Behind its end a plan stays where it is.
    const auto arrival = twin.time_to_arrival();
    if (arrival)
      duration_s = std::min(duration_s, duration<double>(*arrival).count() + plan_step_s);
    const auto count = static_cast<std::size_t>(std::max(duration_s, 0.0) / plan_step_s) + 1;
    positions_.push_back(twin.motion().position.value);
    for (const auto& motion : tmcl::plan::motions(twin, step, count))
      positions_.push_back(motion.position.value);
  }

  double at(double time) const {
    const double index = std::max(time, 0.0) / plan_step_s;
    const auto below = static_cast<std::size_t>(index);
    if (below + 1 >= positions_.size()) return positions_.back();
    const double part = index - static_cast<double>(below);
    return positions_[below] + part * (positions_[below + 1] - positions_[below]);
  }

 private:
  std::vector<double> positions_;
};

/// Where the plan may have had the axis while a sample was read.
struct Planned {
  double least;
  double greatest;

  double difference(double position) const {
    return position - std::clamp(position, least, greatest);
  }
};

Planned planned_at(const Sample& sample, const Track& track, double start) {
  const auto [least, greatest] =
      std::minmax({track.at(sample.time - start), track.at(sample.time + sample.took - start)});
  return {least, greatest};
}

double difference(const Sample& sample, const Track& track, double start) {
  return planned_at(sample, track, start).difference(static_cast<double>(sample.position));
}

double largest_difference(const Recording& recording, const Track& track, double start) {
  double largest = 0;
  for (const auto& sample : recording.samples)
    largest = std::max(largest, std::abs(difference(sample, track, start)));
  return largest;
}

double best_start(const Recording& recording, const Track& track, Start start) {
  double best = start.earliest;
  double least = largest_difference(recording, track, best);
  for (int i = 1; i <= starts_tried; ++i) {
    const double tried = start.earliest + (start.latest - start.earliest) * i / starts_tried;
    const double largest = largest_difference(recording, track, tried);
    if (largest >= least) continue;
    least = largest;
    best = tried;
  }
  return best;
}

}  // namespace

Comparison compare(const Recording& recording, const tmcl::plan::AxisTwin& twin, Start start) {
  const Track track(twin, recording.samples.back().time - start.earliest);
  Comparison comparison;
  comparison.start = best_start(recording, track, start);
  for (const auto& sample : recording.samples) {
    const double off = difference(sample, track, comparison.start);
    comparison.planned.push_back(track.at(sample.time + sample.took - comparison.start));
    comparison.difference.push_back(off);
    if (std::abs(off) <= comparison.largest) continue;
    comparison.largest = std::abs(off);
    comparison.largest_at = sample.time;
  }
  return comparison;
}

std::string summary(const Comparison& comparison, const Recording& recording) {
  const auto microsteps = std::round(comparison.largest);
  const auto in_unit = std::abs(shown_position(microsteps, recording));
  if (microsteps == 0) return "the axis went as planned, to the microstep";
  const bool is_one = microsteps == 1 && !recording.user;
  return fmt::format(
      "the axis was at most {} off its plan, at {:.2f} s",
      shown(InUnit{in_unit, is_one ? "microstep" : recording.position_unit}, microsteps),
      comparison.largest_at);
}

Picture picture_of(const Recording& recording, const Comparison& comparison, const Shown& shown) {
  auto picture = picture_of(recording, shown);
  picture.title += "; " + summary(comparison, recording);
  const auto in_unit = [&](std::vector<double> microsteps) {
    for (auto& value : microsteps) value = shown_position(value, recording);
    return microsteps;
  };
  const auto position = std::ranges::find(picture.curves, "position", &Curve::name);
  if (position != picture.curves.end()) position->planned = in_unit(comparison.planned);
  picture.curves.push_back({"difference", recording.position_unit, position_curve(recording).times,
                            in_unit(comparison.difference)});
  return picture;
}

}  // namespace tmclctl::plot

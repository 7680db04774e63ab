#include "api/course_view.hpp"

#include <algorithm>

#include "tmcl/plan/shaping_report.hpp"

namespace tmcld {

namespace path = tmcl::api::path;
using tmcl::plan::Course;

namespace {

constexpr std::size_t most_corners = 5;

/// One of each word at most.
void note_halt(const tmcl::plan::CourseHalt& halt, path::Course& view) {
  if (halt.waits()) {
    ++view.waits;
    return;
  }
  auto word = std::ranges::find(view.words, halt.word, &path::CarriedOut::number);
  if (word == view.words.end()) {
    word = view.words.insert(view.words.end(), path::CarriedOut{});
    word->number = halt.word;
    word->line = halt.line;
  }
  ++word->times;
}

}  // namespace

std::vector<double> to_list(const tmcl::plan::AxisValues& values, std::size_t axes) {
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(axes)};
}

path::Course view_of(const Course& course, const std::vector<std::string>& names) {
  path::Course view;
  view.length = course.length();
  view.duration_s = course.duration();
  view.legs = course.legs();
  for (std::size_t axis = 0; axis < course.axes(); ++axis) {
    view.axes.push_back(
        {names[axis], course.least()[axis], course.greatest()[axis], course.top_speed(axis)});
  }
  for (const auto& corner : course.slowest_corners(most_corners)) {
    view.slowest_corners.push_back(
        {corner.line, corner.time, corner.speed, to_list(corner.position, course.axes())});
  }
  for (const auto& halt : course.halts()) note_halt(halt, view);
  std::ranges::sort(view.words, {}, &path::CarriedOut::number);
  return view;
}

std::optional<path::Shaping> view_of(const Course& course,
                                     const std::optional<tmcl::plan::Shaping>& shaping,
                                     const std::vector<std::string>& names) {
  if (!shaping) return std::nullopt;
  const auto report = tmcl::plan::report_on_shaping(course, shaping->resonance);
  path::Shaping view{std::string(name_of(shaping->shaper)),
                     shaping->resonance.frequency_hz,
                     shaping->resonance.damping,
                     report.longer_s,
                     report.farthest,
                     report.at_s,
                     {}};
  for (std::size_t axis = 0; axis < course.axes(); ++axis)
    view.axes.push_back({names[axis], report.swing[axis], report.unshaped[axis]});
  return view;
}

path::JerkLimit view_of_jerk(const Course& course, const Course& unlimited,
                             const std::optional<tmcl::ramp::Resonance>& resonance,
                             const std::vector<std::string>& names) {
  const auto report = tmcl::plan::report_on_jerk(course, unlimited, resonance);
  path::JerkLimit view{course.limits().jerk, report.longer_s, {}, {}};
  if (!resonance) return view;
  view.resonance_hz = resonance->frequency_hz;
  for (std::size_t axis = 0; axis < course.axes(); ++axis)
    view.axes.push_back({names[axis], report.swing[axis], report.unlimited[axis]});
  return view;
}

path::Curve curve_of(const Course& course, int points) {
  path::Curve curve;
  for (int i = 0; i <= points; ++i) {
    const double time = course.duration() * i / points;
    curve.times_s.push_back(time);
    curve.positions.push_back(to_list(course.at(time).position, course.axes()));
  }
  return curve;
}

}  // namespace tmcld

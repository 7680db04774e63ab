#include "plot/recording.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>

namespace tmclctl::plot {
namespace {

Curve curve(const Recording& recording, std::string name, std::string unit,
            std::int64_t Sample::*value) {
  Curve made{std::move(name), std::move(unit), {}, {}, {}};
  for (const auto& sample : recording.samples) {
    made.times.push_back(sample.time);
    made.values.push_back(static_cast<double>(sample.*value));
  }
  return made;
}

}  // namespace

Curve position_curve(const Recording& recording) {
  return curve(recording, "position", recording.position_unit, &Sample::position);
}

Curve velocity_curve(const Recording& recording) {
  return curve(recording, "velocity", recording.velocity_unit, &Sample::velocity);
}

std::string summary(const Recording& recording) {
  if (recording.samples.empty()) return fmt::format("{}: nothing was recorded", recording.axis);
  const auto& first = recording.samples.front();
  const auto& last = recording.samples.back();
  const auto fastest = std::ranges::max_element(
      recording.samples, {}, [](const Sample& sample) { return std::abs(sample.velocity); });
  return fmt::format("{} went from {} to {} {} in {:.2f} {}, greatest velocity {}", recording.axis,
                     first.position, last.position, recording.position_unit, last.time - first.time,
                     recording.time_unit, fastest->velocity);
}

std::string to_csv(const Recording& recording) {
  std::string text = "time_s,position_microsteps,velocity_internal\n";
  for (const auto& sample : recording.samples) {
    fmt::format_to(std::back_inserter(text), "{:.6f},{},{}\n", sample.time, sample.position,
                   sample.velocity);
  }
  return text;
}

}  // namespace tmclctl::plot

#include "plot/recording.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>

namespace tmclctl::plot {
namespace {

Curve curve(const Recording& recording, std::string name, std::string unit,
            std::int32_t Sample::*value) {
  Curve made{std::move(name), std::move(unit), {}, {}};
  for (const auto& sample : recording.samples) {
    made.times.push_back(sample.time_s);
    made.values.push_back(sample.*value);
  }
  return made;
}

}  // namespace

Curve position_curve(const Recording& recording) {
  return curve(recording, "position", "microsteps", &Sample::position_microsteps);
}

Curve velocity_curve(const Recording& recording) {
  return curve(recording, "velocity", "internal", &Sample::velocity_internal);
}

std::string summary(const Recording& recording) {
  if (recording.samples.empty()) return fmt::format("{}: nothing was recorded", recording.axis);
  const auto& first = recording.samples.front();
  const auto& last = recording.samples.back();
  const auto fastest = std::ranges::max_element(recording.samples, {}, [](const Sample& sample) {
    return std::abs(std::int64_t{sample.velocity_internal});
  });
  return fmt::format("{} went from {} to {} microsteps in {:.2f} s, greatest velocity {}",
                     recording.axis, first.position_microsteps, last.position_microsteps,
                     last.time_s - first.time_s, fastest->velocity_internal);
}

std::string to_csv(const Recording& recording) {
  std::string text = "time_s,position_microsteps,velocity_internal\n";
  for (const auto& sample : recording.samples) {
    fmt::format_to(std::back_inserter(text), "{:.6f},{},{}\n", sample.time_s,
                   sample.position_microsteps, sample.velocity_internal);
  }
  return text;
}

}  // namespace tmclctl::plot

#include "plot/recording.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>

#include "axis/quantity_text.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclctl::plot {
namespace {

using Shown = double (*)(double recorded, const Recording&);

Curve curve(const Recording& recording, std::string name, std::string unit,
            std::int64_t Sample::*value, Shown shown) {
  Curve made{std::move(name), std::move(unit), {}, {}, {}};
  for (const auto& sample : recording.samples) {
    made.times.push_back(sample.time);
    made.values.push_back(shown(static_cast<double>(sample.*value), recording));
  }
  return made;
}

double position_of(const Sample& sample, const Recording& recording) {
  return shown_position(static_cast<double>(sample.position), recording);
}

double velocity_of(const Sample& sample, const Recording& recording) {
  return shown_velocity(static_cast<double>(sample.velocity), recording);
}

}  // namespace

void use(UserUnit unit, Recording& recording) {
  recording.position_unit = unit.scale.unit;
  recording.velocity_unit = unit.scale.unit + "/s";
  recording.user = std::move(unit);
}

double shown_position(double recorded, const Recording& recording) {
  if (!recording.user) return recorded;
  // As a speed, because that need not be whole.
  return to_user(tmcl::PulsesPerSecond{recorded}, recording.user->scale).value;
}

double shown_velocity(double recorded, const Recording& recording) {
  if (!recording.user) return recorded;
  const auto pps = recorded * recording.user->module.velocity.value;
  return to_user(tmcl::PulsesPerSecond{pps}, recording.user->scale).value;
}

Curve position_curve(const Recording& recording) {
  return curve(recording, "position", recording.position_unit, &Sample::position, shown_position);
}

Curve velocity_curve(const Recording& recording) {
  return curve(recording, "velocity", recording.velocity_unit, &Sample::velocity, shown_velocity);
}

std::string summary(const Recording& recording) {
  if (recording.samples.empty()) return fmt::format("{}: nothing was recorded", recording.axis);
  const auto& first = recording.samples.front();
  const auto& last = recording.samples.back();
  const auto fastest = std::ranges::max_element(
      recording.samples, {}, [](const Sample& sample) { return std::abs(sample.velocity); });
  const auto position = [&](const Sample& sample) {
    return shown_number(position_of(sample, recording), static_cast<double>(sample.position));
  };
  return fmt::format(
      "{} went from {} to {} {} in {:.2f} {}, fastest velocity {} {}", recording.axis,
      position(first), position(last), recording.position_unit, last.time - first.time,
      recording.time_unit,
      shown_number(velocity_of(*fastest, recording), static_cast<double>(fastest->velocity)),
      recording.user ? recording.velocity_unit : '[' + recording.velocity_unit + ']');
}

std::string to_csv(const Recording& recording) {
  std::string text = "time_s,position_microsteps,velocity_internal";
  if (const auto& user = recording.user)
    text += fmt::format(",position_{0},velocity_{0}_per_s", user->scale.unit);
  text += recording.begin_utc ? ",utc\n" : "\n";
  for (const auto& sample : recording.samples) {
    auto end = std::back_inserter(text);
    fmt::format_to(end, "{:.6f},{},{}", sample.time, sample.position, sample.velocity);
    if (recording.user) {
      fmt::format_to(end, ",{},{}", tmcl::plain_number(position_of(sample, recording), 12),
                     tmcl::plain_number(velocity_of(sample, recording), 12));
    }
    if (recording.begin_utc) {
      const auto time = std::chrono::duration<double>(sample.time);
      text += ',' + tmcl::to_text(*recording.begin_utc + std::chrono::round<tmcl::Duration>(time));
    }
    text += '\n';
  }
  return text;
}

}  // namespace tmclctl::plot

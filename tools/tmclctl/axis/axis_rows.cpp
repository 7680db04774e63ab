#include "axis_rows.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "output/print.hpp"

namespace tmclctl {
namespace {

constexpr int least_name_width = 4;
constexpr int most_name_width = 16;
constexpr int state_width = 9;
constexpr int number_width = 14;
constexpr int flags_width = 16;
constexpr int gaps = 10;
constexpr int least_bar_width = 10;
constexpr int most_bar_width = 42;

std::string motion_word(const AxisLine& axis) {
  if (axis.state.empty()) return "?";
  if (axis.state != "ready") return axis.state;
  if (!axis.reading) return "?";
  if (axis.reading->moving) return "moving";
  return axis.reading->position_reached ? "at target" : "stands";
}

std::string bar_text(const AxisLine& axis, int width) {
  if (!axis.reading || !axis.limits) return {};
  const auto& reading = *axis.reading;
  const double position = reading.position.value_or(reading.position_microsteps);
  return place_between(axis.limits->least.value, axis.limits->greatest.value, position, width);
}

}  // namespace

std::string flags_text(const AxisReading& reading) {
  std::string flags;
  const auto add = [&](const std::string& flag) { flags += (flags.empty() ? "" : ", ") + flag; };
  if (!reading.faults.empty()) add("FAULT: " + joined(reading.faults));
  if (reading.latched) add("LATCHED");
  if (reading.stop_cause && !reading.moving) add("stopped: " + *reading.stop_cause);
  if (reading.unattended) add("unattended");
  if (reading.lease) add(fmt::format("lease {}", *reading.lease));
  if (reading.referenced) add("referenced");
  return flags;
}

std::string place_between(double least, double greatest, double value, int width) {
  const int places = width - 2;
  std::string bar(static_cast<std::size_t>(std::max(places, 1)), '.');
  if (value < least) {
    bar.front() = '<';
  } else if (value > greatest) {
    bar.back() = '>';
  } else {
    const auto part = greatest > least ? (value - least) / (greatest - least) : 0;
    bar[static_cast<std::size_t>(std::lround(part * static_cast<double>(bar.size() - 1)))] = '#';
  }
  return '[' + bar + ']';
}

std::vector<std::string> lines_of(const std::vector<AxisLine>& axes, int width, bool internal) {
  int name_width = least_name_width;
  for (const auto& axis : axes)
    name_width = std::clamp(static_cast<int>(axis.name.size()), name_width, most_name_width);
  const int others = name_width + state_width + 2 * number_width + flags_width + gaps;
  const int bar_width = std::clamp(width - others, least_bar_width, most_bar_width);
  const auto line = [&](const auto& name, const auto& state, const auto& position, const auto& bar,
                        const auto& velocity, const auto& flags) {
    auto text = fmt::format("{:<{}}  {:<{}}  {:>{}}  {:<{}}  {:>{}}  {}", name, name_width, state,
                            state_width, position, number_width, bar, bar_width, velocity,
                            number_width, flags);
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  };
  std::vector<std::string> lines{line("AXIS", "STATE", "POSITION", "LIMITS", "VELOCITY", "FLAGS")};
  for (const auto& axis : axes) {
    const auto& reading = axis.reading;
    lines.push_back(
        line(axis.name, motion_word(axis), reading ? position_text(*reading, internal) : "-",
             bar_text(axis, bar_width), reading ? velocity_text(*reading, internal) : "-",
             reading ? flags_text(*reading) : ""));
  }
  return lines;
}

}  // namespace tmclctl

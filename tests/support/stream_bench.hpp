/// One to three simulated axes that pass a course in virtual time: every command takes a while, and
/// every millisecond the axes are looked at.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/module/module.hpp"
#include "support/no_events.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/plan/path_preparation.hpp"
#include "tmcl/plan/ramp_limits.hpp"
#include "tmcl/plan/rehearsal.hpp"
#include "tmcl/plan/stream.hpp"
#include "tmcl/seconds.hpp"

namespace tmcl::plan::test {

namespace ap = axis_parameter;

constexpr double microsteps_per_mm = 51200 / 5.0;
constexpr Duration look_interval = std::chrono::milliseconds(1);
constexpr Duration longest_looked_at = std::chrono::seconds(1);

inline tl::unexpected<Error> no_reply() {
  Error error;
  error.message = "no reply";
  return tl::unexpected(std::move(error));
}

/// The axes of one module, three at most, and a driver that carries out what a stream says.
class StreamBench {
 public:
  explicit StreamBench(std::uint16_t model = 6212, std::size_t axes = 2)
      : model_(*find_model(model)), axes_(axes), module_(model_, ModuleAddress{1}, clock_) {
    limits_.axes = axes;
    limits_.axis[0] = limits_.axis[1] = limits_.axis[2] = {24, 500};
    limits_.corner_tolerance = 0.025;
  }

  Duration round_trip = std::chrono::microseconds(450);
  std::function<void()> every_ms = [] {};
  std::function<void()> at_wait = [] {};
  /// May answer instead of the module, and let time pass.
  std::function<std::optional<tmcl::Result<std::int32_t>>(const DriveCommand&)> instead =
      [](const auto&) { return std::nullopt; };
  double most_deviation = 1;
  std::size_t most_seen = 0;
  std::optional<Shaping> shaping;
  double jerk = std::numeric_limits<double>::infinity();  ///< Along the path.
  std::map<std::uint8_t, StreamEncoder> encoders;         ///< Of axes; the module here has none.
  double slow_clock = 0;  ///< By this part the module is slower than its units say.
  std::vector<DriveCommand> commands;

  /// In mm and seconds; of that, legs leave the spare part. A module that counts in other units
  /// keeps its own, which must allow as much: but for a chip's rounding no axis is planned with
  /// more than it has.
  void limit(double velocity, double acceleration_limit) {
    limits_.axis[0] = limits_.axis[1] = limits_.axis[2] = {velocity, acceleration_limit};
    const auto pps = static_cast<std::int32_t>(velocity * microsteps_per_mm);
    const auto pps2 = static_cast<std::int32_t>(acceleration_limit * microsteps_per_mm);
    for (const auto axis : motors()) {
      ask(Command::SAP, ap::max_velocity, axis, pps);
      ask(Command::SAP, ap::max_acceleration, axis, pps2);
      ask(Command::SAP, 17, axis, pps2);
      const auto own = ramp_limits(model_, ramp_settings(axis));
      const double unit = initial_units(model_).acceleration.value / microsteps_per_mm;
      constexpr double rounding = 128 / microsteps_per_mm;
      EXPECT_GE(own.acceleration * unit, acceleration_limit - rounding);
    }
  }

  /// What becomes of it by the twins of the axes; they stay where they are.
  Rehearsal rehearse(const path_file::Path& path, StreamMode mode) {
    plan(path);
    std::vector<RehearsedAxis> axes;
    for (std::uint8_t axis = 0; axis < course_->axes(); ++axis) {
      const auto known = info(axis);
      axes.push_back({known, *known.twin, settings(axis)});
    }
    return plan::rehearse(*course_, std::move(axes), options_for(mode), round_trip);
  }

  StreamReport pass(const path_file::Path& path, StreamMode mode) {
    plan(path);
    std::vector<StreamAxis> axes;
    for (std::uint8_t axis = 0; axis < course_->axes(); ++axis) axes.push_back(info(axis));
    stream_.emplace(*course_, std::move(axes), options_for(mode));
    while (true) {
      const auto step = stream_->next(clock_.now());
      if (std::holds_alternative<DriveEnd>(step)) return stream_->report();
      if (std::holds_alternative<DriveWait>(step)) at_wait();
      if (const auto* wait = std::get_if<DriveWait>(&step))
        let_pass(std::min<Duration>(std::chrono::milliseconds(1), wait->until - clock_.now()));
      if (const auto* given = std::get_if<DriveCommands>(&step)) {
        for (const auto& command : *given) {
          let_pass(round_trip / 2);
          auto answer = carry_out(command);
          let_pass(round_trip - round_trip / 2);
          stream_->answered(clock_.now(), command.axis, std::move(answer));
        }
      }
    }
  }

  PathStream& stream() { return *stream_; }
  TimePoint now() const { return clock_.now(); }
  const PathLimits& limits() const { return limits_; }
  /// Of legs, as path_axis() has them.
  PathLimits planned_limits() {
    auto planned = limits_;
    for (const auto axis : motors()) {
      auto& velocity = planned.axis[axis].velocity;
      velocity = planned_within(velocity, info(axis));
    }
    return planned;
  }
  /// That was passed last.
  const Course& course() const { return *course_; }
  sim::Module& module() { return module_; }
  /// What is longer than a command is one step.
  void let_pass(Duration time) {
    time = std::max(time, Duration(1));
    const auto step = time > longest_looked_at ? time : look_interval;
    for (; time > Duration::zero(); time -= step) {
      clock_.advance(std::min(time, step));
      module_.run_due();
      if (clock_.now() < looked_at_ + look_interval) continue;
      looked_at_ = clock_.now();
      every_ms();
    }
  }
  double mm(std::uint8_t axis) { return get(axis, ap::actual_position) / microsteps_per_mm; }
  std::int32_t get(std::uint8_t axis, std::uint8_t parameter) {
    return *module_.axis(axis).get(parameter);
  }
  tmcl::Result<std::int32_t> ask(Command command, std::uint8_t type, std::uint8_t axis,
                                 std::int32_t value) {
    const auto reply = module_.execute({ModuleAddress{1}, command, type, axis, value},
                                       sim::Medium::serial, events_);
    if (reply.status != Status::ok) return no_reply();
    return reply.value;
  }
  /// Those of the module, as many as there are axes at most.
  std::span<const std::uint8_t> motors() const {
    static constexpr std::array<std::uint8_t, 3> all{0, 1, 2};
    return std::span(all).first(std::min<std::size_t>(model_.axes, axes_));
  }
  bool moving() {
    return std::ranges::any_of(
        motors(), [&](std::uint8_t motor) { return get(motor, ap::actual_velocity) != 0; });
  }

 private:
  void plan(const path_file::Path& path) {
    limits_.jerk = jerk;
    auto course =
        Course::of(path, planned_limits(), std::numeric_limits<double>::infinity(), shaping);
    EXPECT_TRUE(course) << course.error();
    course_ = std::move(*course);
  }
  StreamOptions options_for(StreamMode mode) const {
    return {.mode = mode, .most_deviation = most_deviation, .most_seen = most_seen};
  }
  std::vector<Setting> settings(std::uint8_t axis) {
    std::vector<Setting> all;
    for (const auto parameter : AxisTwin::parameters(model_))
      all.push_back({parameter, get(axis, parameter)});
    return all;
  }
  std::vector<Setting> ramp_settings(std::uint8_t axis) {
    std::vector<Setting> all;
    for (const auto parameter : ramp_limit_parameters(model_))
      all.push_back({parameter, get(axis, parameter)});
    return all;
  }
  StreamAxis info(std::uint8_t axis) {
    StreamAxis made{microsteps_per_mm,    initial_units(model_), 0, 0, 0,
                    AxisTwin::of(model_), model_.family};
    const auto most = [&](std::uint8_t parameter) {
      const auto* row = find_parameter(axis_parameters(model_), parameter);
      return row != nullptr ? row->maximum : 0;
    };
    made.units.velocity.value *= 1 + slow_clock;
    made.units.acceleration.value *= (1 + slow_clock) * (1 + slow_clock);
    made.greatest_velocity = most(ap::target_velocity);
    made.greatest_velocity = fastest_within(limits_.axis[axis].velocity, made);
    made.greatest_acceleration = most(ap::max_acceleration);
    made.greatest_stop_velocity = most(20);
    if (made.twin) made.twin->set(settings(axis));
    if (const auto found = encoders.find(axis); found != encoders.end())
      made.encoder = found->second;
    return made;
  }

  tmcl::Result<std::int32_t> carry_out(const DriveCommand& command) {
    commands.push_back(command);
    if (auto other = instead(command)) return *other;
    const auto axis = static_cast<std::uint8_t>(command.axis);
    switch (command.kind) {
      case DriveCommand::Kind::get: return ask(Command::GAP, command.parameter, axis, 0);
      case DriveCommand::Kind::set:
        return ask(Command::SAP, command.parameter, axis, command.value);
      case DriveCommand::Kind::rotate:
        return ask(command.value < 0 ? Command::ROL : Command::ROR, 0, axis,
                   std::abs(command.value));
      case DriveCommand::Kind::move_to: return ask(Command::MVP, 0, axis, command.value);
      case DriveCommand::Kind::stop: return ask(Command::MST, 0, axis, 0);
      default: ADD_FAILURE() << "a command of lines"; return 0;
    }
  }

  const Model& model_;
  std::size_t axes_;
  VirtualClock clock_;
  tmcl::test::NoEvents events_;
  sim::Module module_;
  PathLimits limits_;
  TimePoint looked_at_{};
  std::optional<Course> course_;
  std::optional<PathStream> stream_;
};

constexpr double circle_radius = 10;

/// In chords of at most so many mm around (10, 0), from and to (0, 0).
inline path_file::Path circle(double feed, double chord) {
  path_file::Path path{{"X", "Y"}, {}, {}};
  const auto chords = static_cast<int>(std::ceil(2 * std::numbers::pi * circle_radius / chord));
  for (int i = 1; i <= chords; ++i) {
    const double angle = 2 * std::numbers::pi * i / chords;
    path.elements.push_back(path_file::LineTo{
        {circle_radius * (1 - std::cos(angle)), circle_radius * std::sin(angle)}, feed, {}, 1});
  }
  return path;
}

/// On a bus that is too slow for the shortest period an axis waits longer for the update that turns
/// it round: so far another one goes meanwhile, in mm. 0 on a faster bus.
inline double late_turn(const StreamReport& report, double velocity, Duration round_trip) {
  if (report.period <= shortest_stream_period) return 0;
  return velocity * tmcl::seconds(report.period + round_trip);
}

/// How far a point is from the lines of a path that begins at (0, 0).
inline double off(const path_file::Path& path, double x, double y) {
  double nearest = std::hypot(x, y);
  path_file::Point from{};
  for (const auto& element : path.elements) {
    const auto* line = std::get_if<path_file::LineTo>(&element);
    if (line == nullptr) continue;
    const double dx = line->target[0] - from[0], dy = line->target[1] - from[1];
    const double along = ((x - from[0]) * dx + (y - from[1]) * dy) / (dx * dx + dy * dy);
    const double part = std::clamp(along, 0.0, 1.0);
    nearest = std::min(nearest, std::hypot(from[0] + part * dx - x, from[1] + part * dy - y));
    from = line->target;
  }
  return nearest;
}

}  // namespace tmcl::plan::test

#include "tmcl/plan/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "motion/drive/guided_runner.hpp"
#include "motion/drive/place_on_path.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

// Each look seeks the nearest point of the path. A long path is not looked at more often than a
// short one, and not at all while its axes rest on their targets.
constexpr Duration shortest_look_interval = std::chrono::milliseconds(1);
constexpr double most_looks = 20'000;

Duration look_interval_for(const Course& course) {
  return std::max(shortest_look_interval, duration(course.duration() / most_looks));
}

/// What a module with this axis does with the commands of a stream.
class Understudy {
 public:
  Understudy(RehearsedAxis axis, double position)
      : twin_(std::move(axis.twin)), told_(guidance_of(axis.axis.family).told) {
    for (const auto [parameter, value] : axis.settings) settings_[parameter] = value;
    const auto start = std::lround(position * axis.axis.microsteps_per_unit);
    twin_.place({static_cast<std::int32_t>(start)});
    raw_ = twin_.motion().position.value;
    position_ = start;
  }

  Result<std::int32_t> carry_out(const DriveCommand& command) {
    using Kind = DriveCommand::Kind;
    switch (command.kind) {
      case Kind::get: return get(command.parameter);
      case Kind::set: set({command.parameter, command.value}); break;
      case Kind::rotate: turn(command.value); break;
      case Kind::move_to: go_to(command.value); break;
      case Kind::stop: turn(0); break;
      case Kind::set_coordinate:
      case Kind::move_motors: break;  // of lines
      case Kind::carry_out: break;    // of no axis
    }
    return 0;
  }

  void advance(Duration by) {
    twin_.advance(by);
    const auto raw = twin_.motion().position.value;
    position_ += way_from(raw_, raw);
    raw_ = raw;
  }
  double position() const { return static_cast<double>(position_); }
  bool rests_on_target() const {
    return !velocity_ && position_ == target_ && twin_.motion().velocity.value == 0;
  }

 private:
  // The counter of a TMC429 has 24 bits.
  std::int64_t way_from(std::int32_t before, std::int32_t now) const {
    const auto way = std::int64_t{now} - before;
    constexpr std::int64_t turn = 1 << ramp::Tmc429::position_bits;
    return twin_.tmc429() == nullptr ? way : ((way + turn / 2) & (turn - 1)) - turn / 2;
  }

  std::int32_t get(std::uint8_t parameter) const {
    switch (parameter) {
      case ap::actual_position: return static_cast<std::int32_t>(position_);
      case ap::actual_velocity: return twin_.motion().velocity.value == 0 ? 0 : 1;
      case ap::target_position: return target_;
      default: break;
    }
    if (velocity_ && parameter == ap::target_velocity) return *velocity_;
    if (parameter == ap::target_velocity) return setting(ap::max_velocity);
    if (parameter == told_.parameter) return told_.value;
    return setting(parameter);
  }
  std::int32_t setting(std::uint8_t parameter) const {
    const auto found = settings_.find(parameter);
    return found == settings_.end() ? 0 : found->second;
  }

  void set(Setting setting) {
    if (setting.parameter == ap::target_position) return go_to(setting.value);
    settings_[setting.parameter] = setting.value;
    twin_.set(setting);
  }
  void go_to(std::int32_t target) {
    target_ = target;
    velocity_.reset();
    twin_.move_to({target});
  }
  void turn(std::int32_t velocity) {
    velocity_ = velocity;
    twin_.rotate({velocity});
  }

  AxisTwin twin_;
  Setting told_;  // what another parameter reads on the way to a target
  std::map<std::uint8_t, std::int32_t> settings_;
  std::optional<std::int32_t> velocity_ = 0;  // nothing on the way to a target
  std::int32_t target_ = 0;
  std::int32_t raw_ = 0;
  std::int64_t position_ = 0;
};

class Rehearsing {
 public:
  Rehearsing(const Course& course, std::vector<RehearsedAxis> axes, const StreamOptions& options,
             Duration command)
      : course_(course),
        places_(course),
        command_(std::max(command, Duration(1))),
        look_interval_(look_interval_for(course)) {
    const auto start = course.at(0).position;
    for (auto& axis : axes) {
      const auto number = scales_.size();
      scales_.push_back(axis.axis.microsteps_per_unit);
      axis.axis.twin = axis.twin;
      stream_axes_.push_back(axis.axis);
      understudies_.emplace_back(std::move(axis), start[number]);
    }
    auto on_its_own = options;
    on_its_own.waits = false;
    stream_.emplace(course_, stream_axes_, on_its_own);
  }

  Rehearsal run() {
    for (std::size_t commands = 0; commands < most_rehearsed_commands;) {
      const auto step = stream_->next(now_);
      if (std::holds_alternative<DriveEnd>(step)) break;
      if (const auto* wait = std::get_if<DriveWait>(&step)) let_pass(wait->until - now_);
      if (const auto* given = std::get_if<DriveCommands>(&step)) commands += carry_out(*given);
    }
    const auto& report = stream_->report();
    made_.lag_s = report.largest_lag_s;
    made_.fault = report.fault;
    made_.passed_s = stream_->passed();
    return std::move(made_);
  }

 private:
  // One after the other, as on a line; a bus of several lines carries them faster.
  std::size_t carry_out(const DriveCommands& given) {
    for (const auto& command : given) {
      let_pass(command_ / 2);
      Result<std::int32_t> answer = 0;
      if (command.axis < understudies_.size())
        answer = understudies_[command.axis].carry_out(command);
      let_pass(command_ - command_ / 2);
      stream_->answered(now_, command.axis, std::move(answer));
    }
    return given.size();
  }

  void let_pass(Duration time) {
    for (time = std::max(time, Duration(1)); time > Duration::zero();) {
      // Nothing moves before the next command.
      if (std::ranges::all_of(understudies_, &Understudy::rests_on_target))
        next_look_ = now_ + time;
      const auto step = std::min(time, next_look_ - now_);
      for (auto& understudy : understudies_) understudy.advance(step);
      now_ += step;
      time -= step;
      if (now_ < next_look_) continue;
      next_look_ = now_ + look_interval_;
      look();
    }
  }

  void look() {
    if (stream_->phase() != PathStream::Phase::running) return;
    AxisValues position{};
    for (std::size_t axis = 0; axis < understudies_.size(); ++axis)
      position[axis] = understudies_[axis].position() / scales_[axis];
    const double off = places_.nearest(stream_->passed(), position, made_.farthest).off;
    if (off <= made_.farthest) return;
    made_.farthest = off;
    made_.at_s = stream_->passed();
    made_.position = position;
  }

  const Course& course_;
  PlaceFinder places_;
  const Duration command_;
  const Duration look_interval_;
  std::vector<double> scales_;
  std::vector<StreamAxis> stream_axes_;
  std::vector<Understudy> understudies_;
  std::optional<PathStream> stream_;
  TimePoint now_{};
  TimePoint next_look_{look_interval_};
  Rehearsal made_;
};

}  // namespace

Rehearsal rehearse(const Course& course, std::vector<RehearsedAxis> axes,
                   const StreamOptions& options, Duration command) {
  return Rehearsing(course, std::move(axes), options, command).run();
}

}  // namespace tmcl::plan

/// Axes that are played, in virtual time, for what moves several of them together: each of its
/// commands can be made to fail.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tmcl/parameter.hpp"
#include "tmcl/plan/drive.hpp"

namespace tmcl::plan::test {

using std::chrono::milliseconds;
using std::chrono::seconds;
namespace ap = axis_parameter;
using Kind = DriveCommand::Kind;
using FaultKind = DriveFault::Kind;

constexpr Duration exchange = milliseconds(1);
constexpr Duration way_takes = milliseconds(400);
constexpr std::int32_t own_velocity = 1000;
constexpr std::int32_t own_acceleration = 500;

/// An axis that goes to its target in way_takes, at an even speed.
class PlayedAxis {
 public:
  std::map<std::uint8_t, std::int32_t> settings{{ap::max_velocity, own_velocity},
                                                {ap::max_acceleration, own_acceleration}};
  bool never_arrives = false;  // it goes on and on
  bool stands_short = false;   // half-way

  void move_to(std::int32_t target, TimePoint now) {
    from_ = position(now);
    target_ = target;
    begin_ = now;
  }
  void stop(TimePoint now) { from_ = target_ = position(now); }
  std::int32_t target() const { return target_; }
  bool moves(TimePoint now) const {
    return target_ != from_ && part(now) < (stands_short ? 0.5 : 1);
  }
  std::int32_t position(TimePoint now) const {
    return from_ + static_cast<std::int32_t>((target_ - from_) * part(now));
  }
  std::int32_t get(std::uint8_t parameter, TimePoint now) const {
    switch (parameter) {
      case ap::actual_velocity: return moves(now) ? 100 : 0;
      case ap::target_position: return target_;
      case ap::actual_position: return position(now);
      default: return settings.at(parameter);
    }
  }

 private:
  double part(TimePoint now) const {
    if (stands_short && now >= begin_ + way_takes / 2 && target_ != from_) return 0.5;
    const double part = std::chrono::duration<double>(now - begin_) / way_takes;
    return never_arrives ? std::min(part / 1e3, 0.9) : std::min(part, 1.0);
  }

  std::int32_t from_ = 0;
  std::int32_t target_ = 0;
  TimePoint begin_{};
};

inline Error error_with(std::string message, Errc code = Errc::reply_timeout) {
  Error error;
  error.code = code;
  error.message = std::move(message);
  return error;
}

inline bool starts(const DriveCommand& command) {
  return command.kind == Kind::move_to || command.kind == Kind::move_motors;
}

/// Carries out what a drive says, and keeps a record of it.
class DriveScene {
 public:
  explicit DriveScene(std::size_t count) : axes(count) {}
  virtual ~DriveScene() = default;

  /// What answers a command in place of the axis; `index` counts from 0.
  std::function<std::optional<tmcl::Result<std::int32_t>>(const DriveCommand& command,
                                                          std::size_t index)>
      instead = [](const auto&...) { return std::nullopt; };
  std::function<void()> every_step = [] {};

  void run(Drive& drive) {
    while (true) {
      every_step();
      const auto step = drive.next(now_);
      if (std::holds_alternative<DriveEnd>(step)) return;
      if (const auto* wait = std::get_if<DriveWait>(&step)) {
        ASSERT_LT(now_.time_since_epoch(), seconds(60)) << "it does not end";
        now_ = std::max(std::min(wait->until, next_answer()), now_);
      } else {
        for (const auto& command : std::get<DriveCommands>(step)) take(command);
      }
      give_answers(drive);
    }
  }

  TimePoint now() const { return now_; }
  bool all_rest() const {
    return std::ranges::none_of(axes, [&](const auto& axis) { return axis.moves(now_); });
  }
  /// Those of one kind, in the order in which they were given.
  std::vector<DriveCommand> commands(Kind kind) const {
    std::vector<DriveCommand> found;
    std::ranges::copy_if(all_, std::back_inserter(found),
                         [&](const auto& command) { return command.kind == kind; });
    return found;
  }
  const std::vector<DriveCommand>& commands() const { return all_; }

  std::vector<PlayedAxis> axes;

 protected:
  struct UnderWay {
    DriveCommand command;
    std::size_t index;
    TimePoint due;
  };

  /// Called for each command before it is taken.
  virtual void about_to_take(const DriveCommand& /*command*/) {}
  const std::vector<UnderWay>& under_way() const { return under_way_; }

 private:
  void take(const DriveCommand& command) {
    about_to_take(command);
    under_way_.push_back(
        {command, all_.size(), now_ + exchange * static_cast<int>(1 + command.axis)});
    all_.push_back(command);
  }
  TimePoint next_answer() const {
    auto next = TimePoint::max();
    for (const auto& one : under_way_) next = std::min(next, one.due);
    return next;
  }
  void give_answers(Drive& drive) {
    for (std::size_t i = 0; i < under_way_.size();) {
      if (under_way_[i].due > now_) {
        ++i;
        continue;
      }
      const auto done = under_way_[i];
      under_way_.erase(under_way_.begin() + static_cast<std::ptrdiff_t>(i));
      auto answer = instead(done.command, done.index);
      if (!answer) answer = carry_out(done.command);
      drive.answered(now_, done.command.axis, std::move(*answer));
    }
  }
  std::int32_t carry_out(const DriveCommand& command) {
    auto& axis = axes[command.axis];
    switch (command.kind) {
      case Kind::get: return axis.get(command.parameter, now_);
      case Kind::set: axis.settings[command.parameter] = command.value; break;
      case Kind::move_to: axis.move_to(command.value, now_); break;
      case Kind::stop: axis.stop(now_); break;
      case Kind::set_coordinate: coordinates_[command.axis] = command.value; break;
      case Kind::move_motors:
        for (const auto& [motor, target] : coordinates_) {
          if ((command.value >> motor & 1) != 0) axes[motor].move_to(target, now_);
        }
        break;
      case Kind::rotate:
      case Kind::carry_out: ADD_FAILURE() << "a line has no such command"; break;
    }
    return 0;
  }

  TimePoint now_{seconds(1)};
  std::vector<DriveCommand> all_;
  std::vector<UnderWay> under_way_;
  std::map<std::size_t, std::int32_t> coordinates_;
};

}  // namespace tmcl::plan::test

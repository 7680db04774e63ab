/// What a motor drives: the mechanics, the switches on them, and what measures the way; and what is
/// wrong with its cable.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "sim/stage/driver_fault.hpp"
#include "sim/stage/swing.hpp"

namespace tmcl::sim {

/// Places and ways on a stage are counted in 1/256 of a full step: microsteps at the finest
/// resolution, whatever resolution the module happens to use. Nothing that a module forgets, or
/// calls its position, changes where the stage is.
using Place = std::int64_t;

struct Interval {
  Place from = 0;
  Place to = 0;
};

struct EncoderSettings {
  std::int32_t counts_per_turn = 1024;
  bool backwards = false;  ///< Mounted so that it counts down where the motor turns up.
};

/// What is bolted together. What is not there is nothing.
struct StageSettings {
  Place position = 0;                   ///< Where it stands when the bench is switched on.
  std::optional<Place> left_switch{};   ///< Closed here and to the left.
  std::optional<Place> right_switch{};  ///< Closed here and to the right.
  std::optional<Interval> home{};       ///< Closed from here to there.
  Place switch_tolerance = 0;           ///< A closed switch opens so much later.
  bool limits_normally_closed = false;
  bool home_normally_closed = false;
  std::optional<Place> left_stop{};  ///< A mechanical end, against which the motor loses steps.
  std::optional<Place> right_stop{};
  std::optional<EncoderSettings> encoder{};
  std::int32_t full_steps_per_turn = 200;
  std::int32_t load = 0;               ///< In 1/1000 of what the motor can just drive.
  std::int32_t load_per_velocity = 0;  ///< More of it for each full step per second, in 1/1000.
  /// A weight that hangs: towards lower places, or higher ones if it is below 0; in 1/1000.
  std::int32_t pull = 0;
  std::int32_t inertia = 0;  ///< More for each full step per second squared, in 1/1000000.
  /// In full steps per second, at 24 V: above it the torque of the motor falls. Without one, never.
  std::optional<std::int32_t> corner_speed{};
  /// The same: only below it a motor that has lost its steps catches on. Without one, at any speed.
  std::optional<std::int32_t> pull_in_speed{};
  bool torque_follows_current = false;  ///< Otherwise every current is the full one.
  /// So far the load value (206) falls when the motor is asked for all it has.
  std::int32_t load_value_slope = 1000;
  std::int32_t load_value_noise = 0;  ///< It is read so much too high or too low at most.
  DriverFaults faults{};              ///< Of the driver, and of the cable to the motor.
  /// Of the load; the encoder is on that. Without one it is rigidly joined to the motor.
  std::optional<ramp::Resonance> resonance{};
  /// So far the motor turns before the load, with the encoder, follows it the other way.
  Place backlash = 0;
};

/// Levels at the module's inputs, before it makes anything of them.
struct StageInputs {
  bool left = false;
  bool right = false;
  bool home = false;
  bool operator==(const StageInputs&) const = default;
};

enum class StageSwitch : std::uint8_t { left, right, home };

/// How far the stage can go to either side before anything about it changes.
struct Reach {
  static constexpr Place unlimited = std::numeric_limits<Place>::max();
  Place back = unlimited;
  Place ahead = unlimited;
  void limit_back(Place way) { back = way < back ? way : back; }
  void limit_ahead(Place way) { ahead = way < ahead ? way : ahead; }
};

class Stage {
 public:
  Stage() = default;
  explicit Stage(const StageSettings& settings);

  const StageSettings& settings() const { return settings_; }
  /// Nothing on it depends on where it is.
  bool is_bare() const;
  Place position() const { return position_; }

  /// The motor turns by so much, and the stage follows as far as it can.
  void move(Place way);
  /// How the load swings behind the motor; null if it does not.
  Swing* swing() { return swing_ ? &*swing_ : nullptr; }
  const Swing* swing() const { return swing_ ? &*swing_ : nullptr; }
  /// It is pressed against an end in the direction of this sign, or the load holds it: a motor that
  /// goes on does not move it.
  bool holds(int direction) const;
  Reach reach() const;

  StageInputs inputs() const;
  /// A switch is held by hand until it is released.
  void press(StageSwitch which, bool pressed);

  /// What the encoder has counted since the bench was switched on; 0 without one.
  std::int64_t encoder_counts() const;
  /// Where in its turn the encoder is: 0 and up, less than its counts per turn.
  std::int32_t encoder_angle() const;
  /// How far the stage can go to either side before the encoder counts on.
  Reach encoder_reach() const;
  /// Shifts the encoder against the stage.
  void slip(std::int64_t counts) { slip_ += counts; }

  void set_load(std::int32_t load) { settings_.load = load; }

  void set_fault(DriverFault fault, bool on) { settings_.faults.set(fault, on); }

 private:
  // A contact with the place where it is closed, and how it got there.
  struct Contact {
    bool closed = false;
    bool pressed = false;
    bool is_closed() const { return closed || pressed; }
  };
  static constexpr std::int32_t full_load = 1000;

  void settle(bool anew);
  void settle(Contact& contact, const std::optional<Interval>& place, bool anew) const;
  void limit(Reach& reach, const Contact& contact, const std::optional<Interval>& place) const;
  std::optional<Interval> left() const;
  std::optional<Interval> right() const;
  std::int64_t counts_at(Place position) const;
  Place load_position() const;
  Reach reach_of_count() const;

  StageSettings settings_;
  Place position_ = 0;
  Place load_ = 0;  ///< Where the load is: behind the motor by its backlash at most.
  std::int64_t slip_ = 0;
  std::optional<Swing> swing_;
  Contact left_;
  Contact right_;
  Contact home_;
};

}  // namespace tmcl::sim

/// The one way to the right to move an axis: the caller names its action.
///
/// In this order: the module is ready, no other call moves the axis, its soft limits allow the
/// action. All three hold for the moment only, so the bus asks for the last two again before each
/// request that can move the motor: see GatewayBus::run().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>

#include "gateway/axis/axis_units.hpp"

namespace tmcld {

namespace action {
struct MoveTo {
  Length target;
};
/// Where to is computed when the axis has been looked at: Admitted::aim_at() says it then.
struct MoveFromHere {};
struct MoveToCoordinate {
  std::uint8_t number;
};
struct Turn {
  tmcl::InternalVelocity velocity;
};
struct Write {
  std::uint8_t parameter;
  std::int32_t value;
};
struct Restore {
  std::uint8_t parameter;
};
struct Search {};
/// On a course that its planner has checked against the limits.
struct FollowPath {};
}  // namespace action

using AxisAction =
    std::variant<action::MoveTo, action::MoveFromHere, action::MoveToCoordinate, action::Turn,
                 action::Write, action::Restore, action::Search, action::FollowPath>;

/// How what was admitted is run.
class Admitted : public RunOptions {
 public:
  /// What was intended, now that it is known. It is checked before it is sent.
  void aim_at(Length target) const { *aim_ = {action::MoveTo{target}, {}}; }

 private:
  friend class AxisAdmission;
  struct Aim {
    AxisAction action;
    std::optional<AxisUnits::Epoch> checked;  ///< Of the settings that it was checked with.
  };
  Admitted(RunOptions movement, std::shared_ptr<Aim> aim)
      : RunOptions(std::move(movement)), aim_(std::move(aim)) {}

  std::shared_ptr<Aim> aim_;
};

class AxisAdmission {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;
  template <class T>
  using Script = tmcl::Script<tmcl::Result<T>>;

  AxisAdmission(AxisContext& axis, AxisUnits& units) : axis_(axis), units_(units) {}

  /// The right of a call to move the axis, until the axis is stopped.
  RunOptions begin_movement(Permit permit, Deadline deadline) const;
  /// A reference search may have ended unseen: the module is asked.
  /// Errors: Errc::axis_claimed if another call moves it.
  Awaitable<void> be_free(RunOptions movement);

  /// Errors: those of be_ready(), be_free() and check(); nothing was sent.
  Awaitable<Admitted> admit(AxisAction action, RunOptions movement);
  /// Whether the soft limits allow it. Errors: Errc::beyond_soft_limit.
  Script<void> check(AxisAction action);

 private:
  tmcl::Request any_move() const;
  /// What a write to the parameter sets.
  tmcl::Setpoint setpoint_of(std::uint8_t parameter) const;
  bool needs_free_axis(const AxisAction& action) const;
  bool goes_to_position(const AxisAction& action) const;
  Script<void> check_now(AxisAction action, Permit permit);
  Script<void> check_one(action::MoveTo move);
  Script<void> check_one(action::MoveToCoordinate move);
  Script<void> check_one(action::Turn turn);
  Script<void> check_one(action::Write write);
  Script<void> check_one(action::Restore restore);
  template <class Unlimited>
  Script<void> check_one(Unlimited) {
    co_return tmcl::Result<void>{};
  }
  /// Whether the soft limits let the axis go on to the target that its module holds, unless it is
  /// `here` already.
  Script<void> check_held_target(std::optional<std::int32_t> here);
  Script<void> check_held_velocity();
  Script<bool> turns_by_velocity();
  const std::optional<tmcl::SoftLimits>& limits() const { return axis_.config().scale.limits; }
  tmcl::Error beyond_soft_limit(const std::string& what, std::string hint) const;

  AxisContext& axis_;
  AxisUnits& units_;
};

}  // namespace tmcld

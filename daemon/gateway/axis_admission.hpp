/// Who may move an axis, and where to: whether it is free, and its soft limits.
#pragma once

#include <cstdint>
#include <optional>

#include "gateway/axis_units.hpp"

namespace tmcld {

class AxisAdmission {
 public:
  template <class T>
  using Awaitable = boost::asio::awaitable<tmcl::Result<T>>;
  template <class T>
  using Script = tmcl::Script<tmcl::Result<T>>;

  AxisAdmission(AxisAccess& axis, AxisUnits& units) : axis_(axis), units_(units) {}

  /// The right of a call to move the axis, until the axis is stopped.
  RunOptions begin_movement(Permit permit, Deadline deadline) const;
  /// A reference search may have ended unseen: the module is asked.
  /// Errors: Errc::axis_claimed if another call moves it.
  Awaitable<void> be_free(RunOptions movement);

  // Whether the soft limits let the axis go there. Errors: Errc::beyond_soft_limit.
  Script<void> check_target(Length target);
  std::optional<tmcl::Error> objection_to(const Length& target, const tmcl::UserScale& scale) const;
  Script<void> check_coordinate(std::uint8_t number);
  tmcl::Result<void> check_endless(std::int32_t velocity) const;
  Script<void> check_setting(std::uint8_t parameter, std::int32_t value);
  tmcl::Result<void> check_restoring(std::uint8_t parameter) const;

 private:
  /// Whether the soft limits let the axis go on to the target that its module holds, unless it is
  /// `here` already.
  Script<void> check_held_target(std::optional<std::int32_t> here);
  Script<void> check_held_velocity();
  Script<bool> turns_by_velocity();
  const std::optional<tmcl::SoftLimits>& limits() const { return axis_.config().scale.limits; }
  tmcl::Error beyond_soft_limit(const std::string& what, std::string hint) const;

  AxisAccess& axis_;
  AxisUnits& units_;
};

}  // namespace tmcld

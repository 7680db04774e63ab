/// An axis without an encoder: what tells whether it has lost steps is where a limit switch closes.
#pragma once

#include <cstdint>

#include "tmcl/mechanics.hpp"
#include "tmcl/tuning.hpp"
#include "tune/passage.hpp"

namespace tmcl::verbs {

class SwitchedAxis {
 public:
  SwitchedAxis(AxisAddress axis, WatchedAxis& watched, LimitSwitch which, double full_step)
      : axis_(axis), watched_(&watched), which_(which), full_step_(full_step) {}

  /// 1 where the axis goes up away from the switch, -1 where down.
  int away() const { return which_ == LimitSwitch::left ? 1 : -1; }
  /// By some approaches with the ramp that is set, which is slow. Errors: Errc::bad_argument where
  /// the switch does not stop the axis within `travel`, or not at the same place.
  Script<Result<void>> calibrate(ValueRange travel, Duration limit);
  /// Where it closes.
  std::int32_t reference() const { return reference_; }
  /// Less is not seen.
  double tolerance() const;

  /// Sends it there. Trouble is what else ends its move; on its way back the switch, which closes
  /// where steps were lost on the way out.
  Script<Result<Passage>> pass_to(std::int32_t target, Lookout lookout);
  /// Goes to the switch, by `reach` at most with the ramp that is set, and sets the position by it.
  /// Gives back how far that was off. Errors: Errc::move_interrupted if it does not close.
  Script<Result<double>> find_switch(std::int32_t reach, Duration limit);

 private:
  /// Where it stands when the switch has stopped it; nothing if it has come to `target`.
  Script<Result<std::optional<std::int32_t>>> approach(std::int32_t target, Duration limit);
  Script<Result<void>> go_clear(Duration limit);
  Script<Result<bool>> is_closed();
  std::string_view name() const { return which_ == LimitSwitch::left ? "left" : "right"; }
  std::int32_t clearance() const;

  AxisAddress axis_;
  WatchedAxis* watched_;
  LimitSwitch which_;
  double full_step_;  ///< In microsteps.
  std::int32_t reference_ = 0;
  double spread_ = 0;  ///< Of the places at which it closed.
};

}  // namespace tmcl::verbs

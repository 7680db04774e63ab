/// An axis whose encoder is watched while it moves: what it counts, and whether its motor follows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tmcl/mechanics.hpp"
#include "tune/passage.hpp"

namespace tmcl::verbs {

class EncodedAxis {
 public:
  EncodedAxis(AxisAddress axis, WatchedAxis& watched, std::uint8_t encoder, double full_step)
      : axis_(axis), watched_(&watched), encoder_(encoder), full_step_(full_step) {}

  /// By moves between both ends and their middle, with the ramp that is set.
  /// Errors: Errc::move_interrupted if the encoder does not follow.
  Script<Result<void>> calibrate(ValueRange range, Duration limit);
  /// Sends it there, and stops it at the first sign of trouble.
  Script<Result<Passage>> pass_to(std::int32_t target, Lookout lookout);
  /// Sets that at an axis that stands, and looks at it for so long, or until it has moved. Gives
  /// back how far, in microsteps.
  Script<Result<double>> slides_with(plan::Setting setting, Duration span);
  /// To either side, in microsteps.
  double swing_of(const std::vector<ReadingAt>& readings) const;
  /// What stands off by less is not seen.
  double tolerance_at_rest() const;
  /// After trouble: sets its position as the encoder has it. `up`: where it was going; it stands
  /// within `limit`.
  Script<Result<void>> correct(bool up, Duration limit);

  double backlash() const { return backlash_; }
  double counts_per_microstep() const { return ratio_; }

 private:
  struct Sight {
    std::int32_t before = 0;  ///< Its position.
    std::int32_t counted = 0;
    std::int32_t after = 0;
  };

  Script<Result<std::int32_t>> quiet();
  Script<Result<std::int32_t>> counted_at(std::int32_t target, Duration limit);
  Script<Result<Sight>> look();
  Script<Result<std::vector<ReadingAt>>> listen();
  /// Where the encoder says that the motor is, if it was going up last; the other way it is further
  /// down by the backlash.
  double place_of(std::int32_t counted) const;
  /// How far beyond what can be.
  double deviation(const Sight& sight) const;
  double off_at_rest(double place, std::int32_t from, std::int32_t target) const;
  double grain() const;
  /// A ratio that was measured on a short way says less about a long one.
  double uncertainty(double place) const;
  /// By a move up that has held.
  void measure_again(std::int32_t counted, std::int32_t target);
  std::string stray_text(double deviation) const;
  Error cannot_follow(const std::string& what) const;

  AxisAddress axis_;
  WatchedAxis* watched_;
  std::uint8_t encoder_;
  double full_step_;   ///< In microsteps.
  double ratio_ = 0;   ///< Counts per microstep; below 0 where it counts the other way.
  double anchor_ = 0;  ///< A position, and what it counts there, going up.
  double anchor_count_ = 0;
  double measured_way_ = 0;  ///< On which the ratio was measured.
  double backlash_ = 0;
};

}  // namespace tmcl::verbs

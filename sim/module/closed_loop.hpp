/// What the host sees of a closed loop that gets ready: modules of the families TMC4361 and
/// firmware, parameters 129, 132 and 133.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "tmcl/clock.hpp"

namespace tmcl::sim {

/// The motor stands still meanwhile here; a real one turns a little. Nothing can go wrong.
class ClosedLoop {
 public:
  /// No document tells how long it takes.
  static constexpr Duration calibration_time = std::chrono::milliseconds(500);

  /// Parameter 129 was written.
  void set_mode(std::int32_t mode, TimePoint now) {
    calibration_ = mode == 0 ? std::nullopt : std::optional(calibration_.value_or(now));
  }
  /// Parameter 132 was written: 1 begins.
  void initialize_encoder(std::int32_t value, TimePoint now) {
    initialization_ = value == 1 ? std::optional(now) : std::nullopt;
  }

  /// Parameter 133: 1 once it is calibrated, until it is off.
  std::int32_t is_calibrated(TimePoint now) const { return is_done(calibration_, now) ? 1 : 0; }
  /// Whether parameter 132 has become 2.
  bool is_encoder_initialized(TimePoint now) const { return is_done(initialization_, now); }

 private:
  static bool is_done(std::optional<TimePoint> begin, TimePoint now) {
    return begin && now - *begin >= calibration_time;
  }

  std::optional<TimePoint> calibration_;
  std::optional<TimePoint> initialization_;
};

}  // namespace tmcl::sim

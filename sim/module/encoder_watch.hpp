/// A module's encoder counter, and whether the motor is where it says.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "sim/module/coupling.hpp"

namespace tmcl::sim {

/// How many microsteps a count is worth.
struct EncoderScale {
  std::int64_t microsteps = 1;
  std::int64_t counts = 1;

  std::int64_t in_microsteps(std::int64_t count) const {
    const auto whole = count / counts;
    return whole * microsteps + (count - whole * counts) * microsteps / counts;
  }
  /// The most that one count changes a position by.
  std::int64_t greatest_step() const { return std::abs(microsteps / counts) + 1; }
};

class EncoderWatch {
 public:
  void set_scale(const EncoderScale& scale) { scale_ = scale; }
  /// In microsteps; 0 turns the watch off.
  void set_most_deviation(std::int64_t most) { most_ = most; }

  std::int64_t position(const Stage& stage) const {
    return offset_ + scale_.in_microsteps(stage.encoder_counts() - zero_);
  }
  /// Calls the present position so.
  void set_position(std::int64_t position, const Stage& stage) {
    zero_ = stage.encoder_counts();
    offset_ = position;
  }

  bool is_on() const { return most_ != 0; }
  /// The motor's position less the encoder's is more than it may be.
  bool is_exceeded_by(std::int64_t deviation) const {
    return is_on() && (deviation > most_ || deviation < -most_);
  }
  /// Shortens the reach to what the motor can go, from a deviation that is not too great, before it
  /// has to be looked at again.
  void limit(Reach& reach, std::int64_t deviation, const Coupling& coupling) const;

 private:
  EncoderScale scale_;
  std::int64_t most_ = 0;
  std::int64_t zero_ = 0;
  std::int64_t offset_ = 0;
};

}  // namespace tmcl::sim

/// Keeps a noisy bus from filling a disk with log lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "tmcl/clock.hpp"

namespace tmcld {

/// Lets so many lines pass in each period and counts the others.
class LogLimiter {
 public:
  static constexpr std::uint32_t lines_per_period = 10;
  static constexpr tmcl::Duration period = std::chrono::seconds(10);

  /// Nothing if this line must not be written; otherwise how many were held back since the last
  /// one that was.
  std::optional<std::uint64_t> admit(tmcl::TimePoint now) {
    if (!began_ || now - *began_ >= period) {
      began_ = now;
      written_ = 0;
    }
    if (written_ >= lines_per_period) {
      ++held_back_;
      return std::nullopt;
    }
    ++written_;
    const auto held_back = held_back_;
    held_back_ = 0;
    return held_back;
  }

 private:
  std::optional<tmcl::TimePoint> began_;
  std::uint32_t written_ = 0;
  std::uint64_t held_back_ = 0;
};

}  // namespace tmcld

/// Keeps what happens again and again, on a bus or at the door, from filling a disk with log lines.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "tmcl/clock.hpp"

namespace tmcld {

/// Lets so many lines pass in each period and counts the others.
class LogLimiter {
 public:
  static constexpr std::uint32_t lines_per_period = 10;
  static constexpr tmcl::Duration period = std::chrono::seconds(10);

  /// The line, and how many were held back since the last one that was written; nothing if it must
  /// not be written.
  std::optional<std::string> admit(std::string line, tmcl::TimePoint now) {
    if (!began_ || now - *began_ >= period) {
      began_ = now;
      written_ = 0;
    }
    if (written_ >= lines_per_period) {
      ++held_back_;
      return std::nullopt;
    }
    ++written_;
    if (const auto held_back = std::exchange(held_back_, 0))
      line += " (" + std::to_string(held_back) + " lines held back before)";
    return line;
  }

 private:
  std::optional<tmcl::TimePoint> began_;
  std::uint32_t written_ = 0;
  std::uint64_t held_back_ = 0;
};

}  // namespace tmcld

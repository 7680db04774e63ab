/// The one way by which time comes into the project, so that a test of a timer takes no time.
#pragma once

#include <chrono>

namespace tmcl {

using Duration = std::chrono::nanoseconds;
/// A monotonic instant; the origin means nothing.
using TimePoint = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// For people, and for what is laid beside something else: it may jump.
using UtcTime = std::chrono::sys_time<Duration>;

class Clock {
 public:
  virtual ~Clock() = default;
  virtual TimePoint now() const = 0;
};

class RealClock final : public Clock {
 public:
  TimePoint now() const override { return std::chrono::steady_clock::now(); }
  static UtcTime utc() { return std::chrono::system_clock::now(); }
};

/// Stands still until it is told to go on.
class VirtualClock final : public Clock {
 public:
  TimePoint now() const override { return now_; }
  void advance(Duration by) { now_ += by; }
  void advance_to(TimePoint to) { now_ = to; }

 private:
  TimePoint now_{};
};

}  // namespace tmcl

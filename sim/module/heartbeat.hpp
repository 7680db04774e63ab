/// Notices that the host has fallen silent (global parameters 68 and 82).
#pragma once

#include "sim/module/due.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::sim {

class Heartbeat {
 public:
  /// A command came in: the time begins anew.
  void heard(TimePoint now) {
    last_ = now;
    expired_ = false;
  }
  /// The motors were stopped; not again before the next command.
  void expire() { expired_ = true; }
  /// When the silence is too long. A period of zero means never.
  TimePoint due(std::chrono::milliseconds period) const {
    return expired_ || period.count() == 0 ? never : last_ + period;
  }

 private:
  TimePoint last_{};
  bool expired_ = false;
};

}  // namespace tmcl::sim

/// Command 138: the module reports by itself that a motor has reached its target.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "sim/module/axis.hpp"
#include "sim/module/due.hpp"
#include "sim/module/event_sink.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::sim {

/// A movement is reported when it ends on its target, once, to the port that asked for it. A motor
/// that is rotated or stopped meanwhile reports nothing.
///
/// Manuals differ on the value of the command; here, as on newer modules, it is a bit mask of
/// motors.
class TargetEvents {
 public:
  explicit TargetEvents(std::size_t axes) : watches_(axes) {}

  /// For the next positioning of these motors.
  void arm_once(std::uint32_t motors, EventSink& sink);
  /// For every positioning of these motors from now on, and of no others: 0 ends all reports.
  void arm_always(std::uint32_t motors, EventSink& sink);
  /// The sink is about to go.
  void forget(const EventSink& sink);

  void move_begun(std::size_t motor);
  void move_abandoned(std::size_t motor) { watches_[motor].pending = nullptr; }

  TimePoint next_due(const std::deque<Axis>& axes) const;
  /// The axes must have been brought to `now`. Motors that arrived by the same time and for the
  /// same sink share a report.
  void run_due(TimePoint now, const std::deque<Axis>& axes, const Module& module);

 private:
  struct Watch {
    EventSink* armed = nullptr;
    bool always = false;
    EventSink* pending = nullptr;
  };

  void report(std::uint32_t motors, const Module& module);

  std::vector<Watch> watches_;
};

}  // namespace tmcl::sim

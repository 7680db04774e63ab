/// Decides from readings whether a move has arrived. No I/O, no clock.
///
///     under_way --stands at the goal-----------------------------------> arrived
///     under_way --stands in one place elsewhere for Patience::standing--> stands_elsewhere
///     under_way --has had another target for Patience::elsewhere------> sent_elsewhere
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/clock.hpp"
#include "tmcl/units.hpp"

namespace tmcl::plan {

class Arrival {
 public:
  enum class Verdict : std::uint8_t { under_way, arrived, stands_elsewhere, sent_elsewhere };
  struct Patience {
    Duration standing;
    Duration elsewhere{};
    Duration to_begin{};  ///< Before, an axis that stands, or has another target, proves nothing.
  };
  struct Reading {
    TimePoint at{};  ///< Nothing in it is older.
    Microsteps position{};
    Microsteps target{};
    bool stands = false;
    bool at_target = false;  ///< By its position, or by what the module itself says.
  };

  /// Without a goal the move is to whatever target the axis has.
  Arrival(std::optional<Microsteps> goal, TimePoint begin, Patience patience)
      : goal_(goal), begin_(begin), patience_(patience) {}

  /// Readings in the order in which they were taken. Those from before the begin say nothing.
  Verdict judge(const Reading& reading);

 private:
  std::optional<Microsteps> goal_;
  TimePoint begin_;
  Patience patience_;
  std::optional<TimePoint> standing_since_;
  std::optional<TimePoint> elsewhere_since_;
  Microsteps stands_at_{};
};

}  // namespace tmcl::plan

/// Decides from readings whether a move has arrived. No I/O, no clock.
///
///     under_way --stands at the goal--------------------------------> arrived
///     under_way --stands elsewhere for standstill_limit-------------> stands_elsewhere
///     under_way --has had another target for sent_elsewhere_limit---> sent_elsewhere
#pragma once

#include <optional>

#include "target.hpp"

namespace tmclctl {

constexpr tmcl::Duration standstill_limit = std::chrono::seconds(1);
/// A reading may be a little older than it seems, so that one with the old target proves nothing.
constexpr tmcl::Duration sent_elsewhere_limit = std::chrono::milliseconds(200);

class Arrival {
 public:
  enum class Verdict { under_way, arrived, stands_elsewhere, sent_elsewhere };

  Arrival(tmcl::Microsteps goal, tmcl::TimePoint started_at)
      : goal_(goal), started_at_(started_at) {}

  Verdict judge(const AxisReading& reading);

 private:
  tmcl::Microsteps goal_;
  tmcl::TimePoint started_at_;
  std::optional<tmcl::TimePoint> standing_since_;
  std::optional<tmcl::TimePoint> elsewhere_since_;
  std::optional<tmcl::Microsteps> last_position_;
};

}  // namespace tmclctl

#include "arrival.hpp"

namespace tmclctl {
namespace {

// Since when something has been so, given whether it is so now.
void track(std::optional<tmcl::TimePoint>& since, bool now, tmcl::TimePoint at) {
  if (!now) {
    since.reset();
  } else if (!since) {
    since = at;
  }
}

bool lasted(const std::optional<tmcl::TimePoint>& since, tmcl::TimePoint at, tmcl::Duration limit) {
  return since && at - *since >= limit;
}

}  // namespace

Arrival::Verdict Arrival::judge(const AxisReading& reading) {
  // What the daemon remembers from before the move says nothing about it.
  if (reading.taken_at < started_at_) return Verdict::under_way;
  const bool stands = reading.velocity.value == 0;
  if (stands && reading.position == goal_ && reading.target == goal_) return Verdict::arrived;
  track(standing_since_, stands && last_position_ == reading.position, reading.taken_at);
  track(elsewhere_since_, reading.target != goal_, reading.taken_at);
  last_position_ = reading.position;
  if (lasted(elsewhere_since_, reading.taken_at, sent_elsewhere_limit))
    return Verdict::sent_elsewhere;
  if (lasted(standing_since_, reading.taken_at, standstill_limit)) return Verdict::stands_elsewhere;
  return Verdict::under_way;
}

}  // namespace tmclctl

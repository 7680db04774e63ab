#include "tmcl/plan/arrival.hpp"

namespace tmcl::plan {
namespace {

// Since when something has been so, given whether it is so now.
bool lasts(std::optional<TimePoint>& since, bool now, TimePoint at, Duration limit) {
  since = now ? std::optional(since.value_or(at)) : std::nullopt;
  return since && at - *since >= limit;
}

}  // namespace

Arrival::Verdict Arrival::judge(const Reading& reading) {
  const auto& [at, position, target, stands, at_target] = reading;
  const auto goal = goal_.value_or(target);
  if (at < begin_) return Verdict::under_way;
  if (stands && at_target && target == goal) return Verdict::arrived;
  if (at - begin_ < patience_.to_begin) return Verdict::under_way;
  if (position != stands_at_) standing_since_.reset();
  stands_at_ = position;
  const bool stands_long = lasts(standing_since_, stands, at, patience_.standing);
  if (lasts(elsewhere_since_, target != goal, at, patience_.elsewhere))
    return Verdict::sent_elsewhere;
  return stands_long ? Verdict::stands_elsewhere : Verdict::under_way;
}

}  // namespace tmcl::plan

#include "tmcl/plan/limit_search.hpp"

#include <algorithm>
#include <cmath>

namespace tmcl::plan {

std::optional<double> LimitSearch::greatest_held() const {
  if (held_.empty()) return std::nullopt;
  return held_.rbegin()->first;
}

std::optional<double> LimitSearch::beyond(double best) const {
  if (lost_) {
    if (*lost_ <= best * (1 + terms_.precision)) return std::nullopt;
    return std::sqrt(*lost_ * best);
  }
  if (best >= terms_.most) return std::nullopt;
  return std::min(best * terms_.growth, terms_.most);
}

std::optional<double> LimitSearch::next() const {
  if (made_ >= terms_.trials) return std::nullopt;
  if (const auto best = greatest_held()) {
    if (const auto greater = beyond(*best)) return greater;
    // Once it was made to find it.
    if (held_.at(*best) <= terms_.repetitions) return best;
    return std::nullopt;
  }
  if (!lost_) return terms_.first;
  if (*lost_ <= terms_.least) return std::nullopt;
  return std::max(*lost_ / (terms_.growth * terms_.growth), terms_.least);
}

void LimitSearch::tried(double value, bool held) {
  ++made_;
  if (held && (!lost_ || value < *lost_)) {
    ++held_[value];
  } else if (!held) {
    lost_ = std::min(lost_.value_or(value), value);
    held_.erase(held_.lower_bound(value), held_.end());
  }
}

}  // namespace tmcl::plan

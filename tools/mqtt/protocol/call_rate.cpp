#include "protocol/call_rate.hpp"

#include <algorithm>

#include "tmcl/seconds.hpp"

namespace tmclmqtt {

CallRate::Allowance& CallRate::allowance_of(const std::string& user, tmcl::TimePoint now) {
  const auto found = users_.find(user);
  if (found != users_.end()) return found->second;
  if (users_.size() >= most_users) {
    // Of whom nothing has come for longest.
    users_.erase(
        std::ranges::min_element(users_, {}, [](const auto& one) { return one.second.counted; }));
  }
  return users_.emplace(user, Allowance{most_at_once, now, {}}).first->second;
}

CallRate::Verdict CallRate::judge(const std::string& user, tmcl::TimePoint now) {
  auto& its = allowance_of(user, now);
  its.left = std::min(most_at_once, its.left + calls_per_second * tmcl::seconds(now - its.counted));
  its.counted = now;
  if (its.left >= 1) {
    its.left -= 1;
    return Verdict::pass;
  }
  if (its.told && now - *its.told < telling_interval) return Verdict::drop;
  its.told = now;
  return Verdict::refuse;
}

}  // namespace tmclmqtt

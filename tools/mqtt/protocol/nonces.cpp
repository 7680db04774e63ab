#include "protocol/nonces.hpp"

#include <algorithm>

namespace tmclmqtt {

void Nonces::drop_old(tmcl::TimePoint now) {
  while (!given_.empty() && now - given_.front().at > time_to_live_) given_.pop_front();
}

std::string Nonces::give(std::string_view user, tmcl::TimePoint now) {
  drop_old(now);
  const auto is_its = [&](const Given& one) { return one.user == user; };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(given_, is_its));
  if (count >= most_of_a_user) given_.erase(std::ranges::find_if(given_, is_its));
  if (given_.size() >= most) given_.pop_front();
  given_.push_back({std::string(user), draw_(), now});
  return given_.back().nonce;
}

bool Nonces::take(std::string_view user, std::string_view nonce, tmcl::TimePoint now) {
  drop_old(now);
  const auto found = std::ranges::find_if(
      given_, [&](const Given& one) { return one.user == user && one.nonce == nonce; });
  if (found == given_.end()) return false;
  given_.erase(found);
  return true;
}

}  // namespace tmclmqtt

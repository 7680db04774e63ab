#include "gateway/store/invitations.hpp"

#include <algorithm>
#include <utility>

#include "gateway/store/secret.hpp"

namespace tmcld {

std::string Invitations::add(std::string token, tmcl::TimePoint now) {
  std::erase_if(all_, [&](const Known& one) { return one.ends <= now; });
  if (all_.size() >= most_invitations) all_.erase(all_.begin());
  auto secret = new_secret();
  all_.push_back({hash_of(secret), std::move(token), now + time_invited});
  return secret;
}

std::optional<std::string> Invitations::token_by(std::string_view secret,
                                                 tmcl::TimePoint now) const {
  if (all_.empty()) return std::nullopt;
  const auto found = std::ranges::find(all_, hash_of(secret), &Known::hash);
  if (found == all_.end() || found->ends <= now) return std::nullopt;
  return found->token;
}

void Invitations::use(std::string_view secret) {
  std::erase_if(all_, [hash = hash_of(secret)](const Known& one) { return one.hash == hash; });
}

void Invitations::remove_of_token(std::string_view token) {
  std::erase_if(all_, [&](const Known& one) { return one.token == token; });
}

}  // namespace tmcld

#include "fronts/sign_ins.hpp"

#include <algorithm>
#include <utility>

#include "gateway/store/secret.hpp"

namespace tmcld {

std::string SignIns::add(std::string token, tmcl::TimePoint now) {
  const auto of_token = std::ranges::count(all_, token, &Known::token);
  if (of_token >= static_cast<std::ptrdiff_t>(most_sign_ins_of_a_token))
    all_.erase(std::ranges::find(all_, token, &Known::token));
  auto secret = new_secret();
  all_.push_back({{++last_id_, std::move(token), now + time_signed_in}, hash_of(secret)});
  return secret;
}

std::optional<SignIn> SignIns::of_secret(std::string_view secret, tmcl::TimePoint now) const {
  const auto found = std::ranges::find(all_, hash_of(secret), &Known::hash);
  if (found == all_.end() || found->ends <= now) return std::nullopt;
  return *found;
}

bool SignIns::is_in(std::uint64_t id, tmcl::TimePoint now) const {
  const auto found = std::ranges::find(all_, id, &Known::id);
  return found != all_.end() && found->ends > now;
}

void SignIns::remove(std::uint64_t id) {
  std::erase_if(all_, [&](const Known& one) { return one.id == id; });
}

void SignIns::remove_of_token(std::string_view token) {
  std::erase_if(all_, [&](const Known& one) { return one.token == token; });
}

std::vector<SignIn> SignIns::take_ended(tmcl::TimePoint now) {
  std::vector<SignIn> ended;
  for (const auto& one : all_) {
    if (one.ends <= now) ended.push_back(one);
  }
  std::erase_if(all_, [&](const Known& one) { return one.ends <= now; });
  return ended;
}

}  // namespace tmcld

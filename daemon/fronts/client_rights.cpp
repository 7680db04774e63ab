#include "fronts/client_rights.hpp"

namespace tmcld {

Caller ClientRights::caller() const {
  return user_ ? caller_for(*user_, connected_()) : connected_();
}

std::optional<Error> ClientRights::speak_for(const RelayedUser& user) {
  if (user_) {
    return not_now("not_permitted", "this connection speaks for user '" + user_->name + "' already",
                   "a connection of its own for each user");
  }
  if (auto objection = objection_to_relaying(connected_(), user)) return objection;
  user_ = user;
  seen_ = of(caller());
  return std::nullopt;
}

bool ClientRights::have_shrunk() {
  const auto before = std::exchange(seen_, of(caller()));
  return seen_.role < before.role || (before.exceeds_limits && !seen_.exceeds_limits);
}

}  // namespace tmcld

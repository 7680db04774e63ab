#include "api/relay_handlers.hpp"

#include <algorithm>
#include <string>

#include "api/relay.hpp"
#include "api/suggest.hpp"

namespace tmcld {
namespace {

Error not_permitted_to_relay(std::string message, std::string hint = {}) {
  return not_now("not_permitted", std::move(message), std::move(hint));
}

Result<RelayedUser> user_of(const api::relay::SpeakFor& params) {
  using api::relay::SpeakFor;
  if (!is_relayed_user_name(params.user)) {
    return tl::unexpected(param_error<&SpeakFor::user>(
        "bad_argument", "the name of a user has 1 to " + std::to_string(max_relayed_user_bytes) +
                            " letters, digits, '_', '-', '.', '@'"));
  }
  const auto role = std::ranges::find(role_names, params.role);
  if (role != role_names.end())
    return RelayedUser{params.user, static_cast<Role>(role - role_names.begin())};
  return tl::unexpected(
      param_error<&SpeakFor::role>("bad_argument", "'role' is stop, observe, operate or configure",
                                   suggest(params.role, role_names)));
}

}  // namespace

bool is_relayed_user_name(std::string_view name) {
  constexpr std::string_view known =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.@";
  return !name.empty() && name.size() <= max_relayed_user_bytes &&
         name.find_first_not_of(known) == name.npos;
}

std::optional<Error> objection_to_relaying(const Caller& relay, const RelayedUser& user) {
  if (!relay.lends) {
    return not_permitted_to_relay("this client is no relay: it may speak for itself only",
                                  "relay = true in an [[access]] of tmcld.toml makes it one");
  }
  if (user.role <= *relay.lends) return std::nullopt;
  return not_permitted_to_relay("this relay may give the role '" +
                                    std::string(name_of(*relay.lends)) + "', and '" +
                                    std::string(name_of(user.role)) + "' is above that",
                                "'role' of its [[access]] in tmcld.toml says so");
}

Caller caller_for(const RelayedUser& user, const Caller& relay) {
  Caller caller{relay.credentials};
  caller.user = user.name;
  caller.role = relay.lends ? std::min(user.role, *relay.lends) : Role::stop;
  caller.reason =
      relay.lends ? "as its relay says of user '" + user.name + "'" : "its relay is none any more";
  caller.exceeds_limits = relay.exceeds_limits && caller.role == Role::configure;
  return caller;
}

namespace handlers {

Answer<relay::SpeakFor> speak_for(Call& call, const relay::SpeakFor& params) {
  const auto user = co_await must(user_of(params));
  auto* relay = dynamic_cast<Relay*>(call.peer.get());
  auto objection = relay == nullptr ? objection_to_relaying({}, user) : relay->speak_for(user);
  if (objection) co_return std::move(*objection);
  co_return relay::Spoken{user.name, std::string(name_of(user.role))};
}

}  // namespace handlers
}  // namespace tmcld

#include "api/caller.hpp"

#include <algorithm>

#include <unistd.h>

namespace tmcld {
namespace {

/// Null if none of them is meant.
const Account* account_of(std::uint32_t uid, std::span<const std::uint32_t> groups,
                          const AccessConfig& access) {
  const auto user = std::ranges::find(access.users, uid, &Account::id);
  if (user != access.users.end()) return &*user;
  const auto group = std::ranges::find_if(
      access.groups, [&](const Account& one) { return std::ranges::count(groups, one.id) != 0; });
  return group == access.groups.end() ? nullptr : &*group;
}

}  // namespace

Caller caller_with(const Credentials& credentials, std::span<const AccessConfig> access) {
  // Its groups are needed here only.
  Caller caller{{credentials.uid, credentials.pid}};
  if (access.empty()) return caller;
  const auto uid = caller.credentials.uid;
  const bool is_owner = uid == 0 || uid == ::geteuid();
  caller.role = is_owner ? Role::configure : Role::stop;
  caller.reason = is_owner
                      ? "runs as root, or as tmcld does"
                      : "no [[access]] names user " + std::to_string(uid) + " or one of its groups";
  for (const auto& one : access) {
    const auto* account = account_of(uid, credentials.groups, one);
    if (account == nullptr) continue;
    if (one.relays) caller.lends = std::max(caller.lends.value_or(Role::stop), one.role);
    if (one.role <= caller.role) continue;
    caller.role = one.role;
    caller.reason = "by [[access]] for '" + account->name + "'";
  }
  caller.exceeds_limits = caller.role == Role::configure;
  return caller;
}

Role role_for(const tmcl::Intent& intent) {
  const bool names_motors =
      intent.subject == tmcl::Subject::motor || intent.subject == tmcl::Subject::several;
  const bool is_operating =
      (names_motors && !intent.is_unseen) || intent.motion == tmcl::Motion::by_program;
  switch (intent.effect) {
    case tmcl::Effect::stops: return Role::stop;
    case tmcl::Effect::reads: return Role::observe;
    case tmcl::Effect::writes:
      return intent.subject == tmcl::Subject::output ? Role::operate : Role::configure;
    // What else can move a motor restores settings, restarts the module or writes registers.
    case tmcl::Effect::moves: break;
  }
  return is_operating ? Role::operate : Role::configure;
}

std::optional<Error> objection_by_role(const Caller& caller, Role needed, std::string_view what) {
  if (caller.role >= needed) return std::nullopt;
  const auto role = std::string(name_of(needed));
  auto error = not_now("not_permitted",
                       std::string(what) + " needs the role '" + role + "', and this client has '" +
                           std::string(name_of(caller.role)) + "' (" + caller.reason + ")",
                       "'users' or 'groups' of an [[access]] with role = \"" + role +
                           "\" in tmcld.toml give it, or a token with it");
  error.subject["role"] = name_of(caller.role);
  error.subject["needs_role"] = role;
  return error;
}

}  // namespace tmcld

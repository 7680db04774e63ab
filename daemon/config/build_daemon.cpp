#include <array>
#include <optional>
#include <string>

#include <grp.h>
#include <pwd.h>

#include <fmt/format.h>

#include "config/build_sections.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

constexpr std::size_t max_socket_path_bytes = 107;  // sun_path, with its end
constexpr std::array<std::string_view, 4> level_names{"error", "warning", "info", "debug"};
constexpr std::array<std::string_view, 2> exit_names{"stop", "keep"};

std::optional<std::uint32_t> user_named(const std::string& name) {
  const auto* entry = ::getpwnam(name.c_str());
  return entry == nullptr ? std::nullopt : std::optional<std::uint32_t>(entry->pw_uid);
}

std::optional<std::uint32_t> group_named(const std::string& name) {
  const auto* entry = ::getgrnam(name.c_str());
  return entry == nullptr ? std::nullopt : std::optional<std::uint32_t>(entry->gr_gid);
}

void add_accounts(Draft& draft, const Said<ConfigTexts>& names,
                  std::optional<std::uint32_t> (*find)(const std::string&), std::string_view kind,
                  std::vector<Account>& into) {
  for (const auto& name : names.value_or(ConfigTexts{})) {
    const auto id = find(name);
    if (id) into.push_back({name, *id});
    if (id) continue;
    draft.complain(names, fmt::format("there is no {} {} on this computer", kind, quoted(name)));
  }
}

/// It is written by a daemon, which may have been started anywhere.
void check_managed(Draft& draft, const Said<std::string>& path) {
  if (!path || path->starts_with('/')) return;
  draft.complain(path, "'managed' must be a whole path, such as /var/lib/tmcld/managed.toml");
}

void check_socket(Draft& draft, const Said<std::string>& path) {
  if (!path || (!path->empty() && path->size() <= max_socket_path_bytes)) return;
  draft.complain(path,
                 fmt::format("'socket' must be a path of 1..{} bytes", max_socket_path_bytes));
}

}  // namespace

void add_daemon(Draft& draft, const DaemonSection& section) {
  auto& daemon = draft.config.daemon;
  check_socket(draft, section.socket);
  set(section.socket, daemon.socket);
  draft.set_choice(section.log_level, level_names, daemon.log_level);
  draft.set_choice(section.on_exit, exit_names, daemon.on_exit);
  set(section.state, daemon.state);
  set(section.audit, daemon.audit);
  set(section.moves_need_lease, daemon.moves_need_lease);
  set(section.planning_memory_mb, daemon.planning_memory_mb);
  check_managed(draft, section.managed);
  set(section.managed, daemon.managed);
}

void add_access(Draft& draft, const AccessSection& section) {
  auto& access = draft.config.access.emplace_back();
  // A stop is not there to be given: everybody has it.
  auto given = static_cast<std::uint8_t>(0);
  draft.set_choice(section.role, std::span(role_names).subspan(1), given);
  access.role = static_cast<Role>(given + 1);
  add_accounts(draft, section.users, user_named, "user", access.users);
  add_accounts(draft, section.groups, group_named, "group", access.groups);
  set(section.relay, access.relays);
  if (section.users || section.groups) return;
  draft.complain(section.place, "[[access]] needs 'users' or 'groups': who has the role");
}

}  // namespace tmcld

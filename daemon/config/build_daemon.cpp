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

void add_accounts(Draft& draft, const ConfigSection& section, std::string_view key,
                  std::optional<std::uint32_t> (*find)(const std::string&),
                  std::vector<Account>& into) {
  const auto* names = section.get<ConfigTexts>(key);
  if (names == nullptr) return;
  for (const auto& name : *names) {
    const auto id = find(name);
    if (id) into.push_back({name, *id});
    if (id) continue;
    draft.complain(section.place_of(key),
                   fmt::format("there is no {} {} on this computer",
                               key == "users" ? "user" : "group", quoted(name)));
  }
}

void add_socket(Draft& draft, const ConfigSection& section, const std::string& path) {
  if (path.empty() || path.size() > max_socket_path_bytes) {
    draft.complain(
        section.place_of("socket"),
        "'socket' must be a path of 1.." + std::to_string(max_socket_path_bytes) + " bytes");
  }
  draft.config.daemon.socket = path;
}

}  // namespace

void add_daemon(Draft& draft, const ConfigSection& section) {
  if (const auto* socket = section.get<std::string>("socket")) add_socket(draft, section, *socket);
  draft.set_choice(section, "log_level", level_names, draft.config.daemon.log_level);
  draft.set_choice(section, "on_exit", exit_names, draft.config.daemon.on_exit);
  if (const auto* state = section.get<std::string>("state")) draft.config.daemon.state = *state;
  if (const auto* file = section.get<std::string>("audit")) draft.config.daemon.audit = *file;
  if (const auto* flag = section.get<bool>("moves_need_lease"))
    draft.config.daemon.moves_need_lease = *flag;
  if (const auto* megabytes = section.get<std::int64_t>("planning_memory_mb"))
    draft.config.daemon.planning_memory_mb = static_cast<std::size_t>(*megabytes);
}

void add_access(Draft& draft, const ConfigSection& section) {
  auto& access = draft.config.access.emplace_back();
  // A stop is not there to be given: everybody has it.
  auto given = static_cast<std::uint8_t>(0);
  draft.set_choice(section, "role", std::span(role_names).subspan(1), given);
  access.role = static_cast<Role>(given + 1);
  add_accounts(draft, section, "users", user_named, access.users);
  add_accounts(draft, section, "groups", group_named, access.groups);
  if (section.find("users") != nullptr || section.find("groups") != nullptr) return;
  draft.complain(section.place, "[[access]] needs 'users' or 'groups': who has the role");
}

}  // namespace tmcld

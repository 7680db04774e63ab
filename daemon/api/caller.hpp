/// Who makes calls, to the operating system, and what the configuration lets it do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "api/error.hpp"
#include "config/config.hpp"
#include "tmcl/intent.hpp"

namespace tmcld {

struct Credentials {
  std::uint32_t uid = 0;
  std::int32_t pid = 0;
  std::vector<std::uint32_t> groups{};
};

struct Caller {
  Credentials credentials{};
  Role role = Role::configure;
  std::string reason{};  ///< Why it has that role: "by [[access]] for 'anna'".
  /// The limits of axes do not hold for it.
  bool exceeds_limits = false;
  /// The highest role that users may have whom it speaks for; nothing: it speaks for itself only.
  std::optional<Role> lends{};
  std::string user{};  ///< Whom a relay speaks for; empty: itself.
};

/// With the highest role of those that the configuration gives it. Root and the user of this
/// process may do everything: they could change the configuration as well.
Caller caller_with(const Credentials& credentials, std::span<const AccessConfig> access);

/// Who may send a request: what moves a motor or an output is operating, whatever else changes
/// something is configuring.
Role role_for(const tmcl::Intent& intent);

/// Why the caller may not have it; nothing if it may. `what`: such as "axis.move_to".
std::optional<Error> objection_by_role(const Caller& caller, Role needed, std::string_view what);

}  // namespace tmcld

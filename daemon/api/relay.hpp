/// What a front is to the method by which a relay names the user that it speaks for. The relay is
/// trusted to know its users; what it may do for them, and for itself, is the configuration's.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "api/caller.hpp"

namespace tmcld {

/// Of the name of a user, as a relay says it.
constexpr std::size_t max_relayed_user_bytes = 64;

struct RelayedUser {
  std::string name;
  Role role = Role::stop;
};

/// 1 to 64 letters, digits, '_', '-', '.', '@': such a name can be told in any line of text.
bool is_relayed_user_name(std::string_view name);
/// Why the caller may not speak for that user; nothing if it may.
std::optional<Error> objection_to_relaying(const Caller& relay, const RelayedUser& user);
/// The user as a caller of its own; without any role but to stop, once the relay is none any more.
Caller caller_for(const RelayedUser& user, const Caller& relay);

/// A Peer of a front whose clients may be relays is one, too.
class Relay {
 public:
  virtual ~Relay() = default;
  /// From now on its calls are those of the user. Errors: it may not, or speaks for one already.
  virtual std::optional<Error> speak_for(RelayedUser user) = 0;
};

}  // namespace tmcld

/// What a connected client may do: by the configuration of now, and as whom it speaks.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "api/caller.hpp"
#include "api/relay.hpp"

namespace tmcld {

class ClientRights {
 public:
  /// `connected`: who has connected, worked out anew each time.
  explicit ClientRights(std::function<Caller()> connected)
      : connected_(std::move(connected)), seen_(of(connected_())) {}

  /// For whom calls are made.
  Caller caller() const;
  /// Calls are those of the user from now on. Errors: it may not, or speaks for one already.
  std::optional<Error> speak_for(const RelayedUser& user);
  /// Whether they are less than when this was asked last.
  bool have_shrunk();

 private:
  struct Seen {
    Role role = Role::stop;
    bool exceeds_limits = false;
  };
  static Seen of(const Caller& caller) { return {caller.role, caller.exceeds_limits}; }

  std::function<Caller()> connected_;
  std::optional<RelayedUser> user_{};
  Seen seen_;
};

}  // namespace tmcld

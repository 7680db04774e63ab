#include "client/socket_hints.hpp"

#include <cerrno>
#include <string_view>

#include <fmt/format.h>

namespace tmcl::client {
namespace {

// Debian's policy: groups below are the system's, and many of them may do more than share a socket.
constexpr gid_t first_own_group = 1000;
// But for the one that the package of tmcld makes.
constexpr std::string_view packaged_group = "tmcl";

/// Not the system's, and not that of one user only.
bool is_for_sharing(const FileOwner& owner) {
  const bool is_own = owner.group_id >= first_own_group && owner.group != owner.user;
  return is_own || owner.group == packaged_group;
}

}  // namespace

std::string access_hint(const FileOwner& owner) {
  const auto who =
      fmt::format("the socket is for user '{}' and group '{}'", owner.user, owner.group);
  if (is_for_sharing(owner)) {
    return fmt::format("{}: join the group with 'sudo adduser $USER {}', and log in again", who,
                       owner.group);
  }
  return fmt::format(
      "{}. Become that user, or let tmcld give the socket to a group made for it: 'sudo addgroup "
      "tmcl', 'sudo adduser $USER tmcl', log in again, and start it with 'sudo sg tmcl -c \"tmcld "
      "--config FILE\"'",
      who);
}

std::string hint_for(int reason, const std::string& path) {
  if (reason == EACCES) {
    const auto owner = owner_of(path);
    return owner ? access_hint(*owner)
                 : "this user may not look into the directory of the socket: ask who started tmcld";
  }
  if (reason == EAGAIN)
    return "The daemon does not accept connections: is it stopped or overloaded?";
  return "Is tmcld running? 'tmcld --config FILE' starts it; its configuration names the socket";
}

std::string hint_after_loss() {
  return "What tmcld wrote to its standard error says what became of it; 'tmcld --config FILE' "
         "starts it again";
}

}  // namespace tmcl::client

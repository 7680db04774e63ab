/// What to try when tmcld's socket cannot be used.
#pragma once

#include <string>

#include <sys/types.h>

namespace tmcl::client {

/// Whose the file of a socket is; who may open it is its owner and its group.
struct SocketOwner {
  std::string user;
  std::string group;
  gid_t group_id = 0;
};

/// For who may not open it.
std::string access_hint(const SocketOwner& owner);
/// For an errno of connect().
std::string hint_for(int reason, const std::string& path);
/// For a connection that broke.
std::string hint_after_loss();

}  // namespace tmcl::client

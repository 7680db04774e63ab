/// What to try when tmcld's socket cannot be used.
#pragma once

#include <string>

#include "link/file_owner.hpp"

namespace tmcl::client {

/// For who may not open the file of a socket, which is for its owner and its group.
std::string access_hint(const FileOwner& owner);
/// For an errno of connect().
std::string hint_for(int reason, const std::string& path);
/// For a connection that broke.
std::string hint_after_loss();

}  // namespace tmcl::client

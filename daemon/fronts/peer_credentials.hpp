/// Who is at the other end of a unix socket.
#pragma once

#include "api/caller.hpp"

namespace tmcld {

/// As the kernel had it when the other end connected; with all of its groups. Empty if the
/// kernel does not tell.
Credentials credentials_of_peer(int socket);

}  // namespace tmcld

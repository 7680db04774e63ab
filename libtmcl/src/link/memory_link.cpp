#include <array>
#include <cerrno>

#include <sys/socket.h>

#include "link/opening.hpp"

namespace tmcl {

Result<std::pair<Link, Link>> Link::memory_pair(Framing framing) {
  std::array<int, 2> ends{};
  const int type = framing == Framing::serial ? SOCK_STREAM : SOCK_SEQPACKET;
  if (socketpair(AF_UNIX, type | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return cannot_open("memory", system_text(errno), "");
  }
  return std::pair{adopt(ends[0], framing, "memory"), adopt(ends[1], framing, "memory")};
}

}  // namespace tmcl

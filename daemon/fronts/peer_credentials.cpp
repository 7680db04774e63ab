#include "fronts/peer_credentials.hpp"

#include <sys/socket.h>

namespace tmcld {
namespace {

constexpr std::uint32_t uid_of_nobody = 65534;
std::vector<std::uint32_t> groups_of_peer(int socket) {
  socklen_t size = 0;  // the first call says how much there is
  ::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, nullptr, &size);
  std::vector<gid_t> groups(size / sizeof(gid_t));
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERGROUPS, groups.data(), &size) != 0) return {};
  return {groups.begin(), groups.end()};
}

}  // namespace

Credentials credentials_of_peer(int socket) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return {uid_of_nobody};
  Credentials credentials{peer.uid, peer.pid, groups_of_peer(socket)};
  credentials.groups.push_back(peer.gid);
  return credentials;
}

}  // namespace tmcld

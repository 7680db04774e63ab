#include "memory/tcp_peer.hpp"

#include <cerrno>
#include <stdexcept>

#include <arpa/inet.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tmcld::test {
namespace {

sockaddr_in on_this_computer(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

}  // namespace

TcpPeer::TcpPeer(std::uint16_t port)
    : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const auto address = on_this_computer(port);
  if (::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    throw std::runtime_error("cannot connect");
}

TcpPeer::~TcpPeer() { ::close(descriptor_); }

void TcpPeer::say(std::string_view bytes) {
  if (::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) return;
  // The kernel passes it on when it gets to it: what the other end has is acknowledged.
  int unacknowledged = 1;
  while (unacknowledged > 0 && !is_cut_off())
    if (::ioctl(descriptor_, SIOCOUTQ, &unacknowledged) != 0) return;
}

void TcpPeer::read() {
  char bytes[4096];
  while (!is_cut_off_) {
    const auto count = ::recv(descriptor_, bytes, sizeof bytes, MSG_DONTWAIT);
    is_cut_off_ = count == 0 || (count < 0 && errno != EAGAIN);
    if (count <= 0) return;
    heard_.append(bytes, static_cast<std::size_t>(count));
  }
}

const std::string& TcpPeer::heard() {
  read();
  return heard_;
}

void TcpPeer::forget() {
  read();
  heard_.clear();
}

bool TcpPeer::is_cut_off() {
  read();
  return is_cut_off_;
}

std::uint16_t free_tcp_port() {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  auto address = on_this_computer(0);
  socklen_t size = sizeof address;
  const bool is_bound =
      ::bind(descriptor, reinterpret_cast<sockaddr*>(&address), size) == 0 &&
      ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  ::close(descriptor);
  if (!is_bound) throw std::runtime_error("no TCP port is free");
  return ntohs(address.sin_port);
}

}  // namespace tmcld::test

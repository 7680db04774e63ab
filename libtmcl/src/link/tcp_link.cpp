#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "link/opening.hpp"

namespace tmcl {
namespace {

using AddressList = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

/// 0 when the descriptor can be written to, or an errno. Signals do not end the wait.
int wait_for_room(int descriptor, TimePoint deadline) {
  pollfd waiting{descriptor, POLLOUT, 0};
  while (true) {
    const auto left = std::max(Duration{}, deadline - RealClock().now());
    const auto timeout = std::chrono::ceil<std::chrono::milliseconds>(left).count();
    const int ready = poll(&waiting, 1, static_cast<int>(timeout));
    if (ready > 0) return 0;
    if (ready == 0) return ETIMEDOUT;
    if (errno != EINTR) return errno;
  }
}

/// 0, or the errno of a connection attempt.
int connect_until(TimePoint deadline, int descriptor, const addrinfo& address) {
  if (connect(descriptor, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS) return errno;
  if (const int failure = wait_for_room(descriptor, deadline); failure != 0) return failure;
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size) != 0) return errno;
  return error;
}

int count(const addrinfo& first) {
  int addresses = 0;
  for (const auto* address = &first; address != nullptr; address = address->ai_next) ++addresses;
  return addresses;
}

// After so long without a sign of the other end the connection is over: what waits would come late.
constexpr unsigned longest_without_sign_ms = 2000;

void prefer_speed_and_notice_death(int descriptor) {
  const int on = 1;
  setsockopt(descriptor, IPPROTO_TCP, TCP_USER_TIMEOUT, &longest_without_sign_ms,
             sizeof longest_without_sign_ms);
  setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(descriptor, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
}

}  // namespace

bool abort_connection(int descriptor) {
  int protocol = 0;
  socklen_t size = sizeof protocol;
  const bool is_tcp = getsockopt(descriptor, SOL_SOCKET, SO_PROTOCOL, &protocol, &size) == 0 &&
                      protocol == IPPROTO_TCP;
  sockaddr nowhere{};
  nowhere.sa_family = AF_UNSPEC;
  return is_tcp && connect(descriptor, &nowhere, sizeof nowhere) == 0;
}

Result<Link> open_tcp(const TcpName& name, const std::string& text, const LinkOptions& options) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* first = nullptr;
  const int failure =
      getaddrinfo(name.host.c_str(), std::to_string(name.port).c_str(), &wanted, &first);
  if (failure != 0) return cannot_open(text, gai_strerror(failure), "check the host's name");
  const AddressList addresses(first, &freeaddrinfo);

  int error = 0;
  const auto end = RealClock().now() + options.connect_timeout;
  auto untried = count(*addresses);
  for (const auto* address = addresses.get(); address != nullptr; address = address->ai_next) {
    // One that does not answer leaves the others their share.
    const auto now = RealClock().now();
    const auto deadline = now + (end - now) / untried--;
    const int descriptor =
        socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0) {
      error = errno;
      continue;
    }
    Link link(descriptor, Framing::serial, text);
    error = connect_until(deadline, descriptor, *address);
    if (error != 0) continue;
    prefer_speed_and_notice_death(descriptor);
    return link;
  }
  return cannot_open(text, system_text(error),
                     "is the converter (or tmclsim) running, and the port right?");
}

}  // namespace tmcl

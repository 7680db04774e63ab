#include "client/line_socket.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "client/socket_hints.hpp"

namespace tmcl::client {
namespace {

constexpr auto cancel_poll_interval = std::chrono::milliseconds(50);

Error unreachable(const std::string& path, int reason) {
  return {std::string(error_name::unreachable), ErrorKind::failed, Outcome::not_sent,
          fmt::format("cannot connect to tmcld at {}: {}", path, std::strerror(reason)),
          hint_for(reason, path)};
}

Error interrupted(Outcome outcome) {
  return {std::string(error_name::cancelled),
          ErrorKind::interrupted,
          outcome,
          "interrupted before tmcld answered",
          {}};
}

/// A connected descriptor, or an errno.
tl::expected<int, int> connect_to(const sockaddr_un& address) {
  const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return tl::unexpected(errno);
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return descriptor;
  const int reason = errno;
  ::close(descriptor);
  return tl::unexpected(reason);
}

/// Whether a daemon that starts at this moment would change that, or has changed it since. A socket
/// that refuses is not listened on yet, or was left by a daemon that was killed: the next one
/// replaces it.
bool may_come_right(int reason, const std::string& path) {
  // Many connect at the same time, and the daemon has not taken them in yet.
  if (reason == EAGAIN) return true;
  if (reason == ENOENT) return may_appear(path);
  std::error_code unreadable;
  return reason == ECONNREFUSED && std::filesystem::is_socket(path, unreadable);
}

}  // namespace

Result<LineSocket> LineSocket::open(const std::string& path, Duration wait,
                                    std::function<bool()> cancelled) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) {
    return tl::unexpected(unreachable(path, path.empty() ? ENOENT : ENAMETOOLONG));
  }
  std::ranges::copy(path, std::begin(address.sun_path));
  const auto began = RealClock{}.now();
  while (true) {
    const auto connected = connect_to(address);
    if (connected) return LineSocket(*connected, path, std::move(cancelled));
    const auto waited = RealClock{}.now() - began;
    if (waited >= wait || !may_come_right(connected.error(), path)) {
      auto error = unreachable(path, connected.error());
      error.message += waited_text(waited);
      return tl::unexpected(std::move(error));
    }
    if (cancelled && cancelled()) return tl::unexpected(interrupted(Outcome::not_sent));
    std::this_thread::sleep_for(std::min<Duration>(file_look_interval, wait - waited));
  }
}

LineSocket::LineSocket(int descriptor, std::string path, std::function<bool()> cancelled)
    : descriptor_(descriptor), path_(std::move(path)), cancelled_(std::move(cancelled)) {}

LineSocket::LineSocket(LineSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      cancelled_(std::move(other.cancelled_)),
      received_(std::move(other.received_)) {}

LineSocket& LineSocket::operator=(LineSocket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  path_ = std::move(other.path_);
  cancelled_ = std::move(other.cancelled_);
  received_ = std::move(other.received_);
  return *this;
}

LineSocket::~LineSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Error LineSocket::lost(std::string_view why) const {
  return {std::string(error_name::lost), ErrorKind::failed, Outcome::unknown,
          fmt::format("the connection to tmcld at {} broke: {}", path_, why), hint_after_loss()};
}

Result<bool> LineSocket::wait_for(short events, TimePoint deadline) {
  while (true) {
    if (cancelled_ && cancelled_()) return tl::unexpected(interrupted(Outcome::unknown));
    const auto left = deadline - RealClock{}.now();
    if (left <= Duration::zero()) return false;
    const auto slice = std::chrono::ceil<std::chrono::milliseconds>(
        std::min<Duration>(left, cancel_poll_interval));
    pollfd entry{descriptor_, events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(slice.count()));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return tl::unexpected(lost(std::strerror(errno)));
  }
}

Result<void> LineSocket::write_line(std::string line, TimePoint deadline) {
  line += '\n';
  std::string_view rest = line;
  while (!rest.empty()) {
    const auto written = ::send(descriptor_, rest.data(), rest.size(), MSG_NOSIGNAL);
    if (written >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno == EAGAIN) {
      const auto writable = wait_for(POLLOUT, deadline);
      if (!writable) return tl::unexpected(writable.error());
      if (!*writable) return tl::unexpected(lost("it takes nothing more"));
    } else if (errno != EINTR) {
      return tl::unexpected(lost(std::strerror(errno)));
    }
  }
  return {};
}

std::optional<std::string> LineSocket::take_line() {
  const auto end = received_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  auto line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

Result<void> LineSocket::receive() {
  std::array<char, 16384> buffer;
  const auto got = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
  if (got == 0) return tl::unexpected(lost("the daemon closed it"));
  if (got < 0) {
    if (errno == EAGAIN || errno == EINTR) return {};
    return tl::unexpected(lost(std::strerror(errno)));
  }
  received_.append(buffer.data(), static_cast<std::size_t>(got));
  if (received_.size() > max_line_bytes) return tl::unexpected(lost("a line without end came"));
  return {};
}

Result<std::optional<std::string>> LineSocket::read_line(TimePoint deadline) {
  while (true) {
    if (auto line = take_line()) return line;
    const auto readable = wait_for(POLLIN, deadline);
    if (!readable) return tl::unexpected(readable.error());
    if (!*readable) return std::optional<std::string>{};
    if (const auto received = receive(); !received) return tl::unexpected(received.error());
  }
}

}  // namespace tmcl::client

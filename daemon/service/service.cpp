#include "service/service.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace tmcld {
namespace {

constexpr int first_passed_descriptor = 3;

std::string_view variable(const char* name) {
  const auto* value = std::getenv(name);
  return value == nullptr ? std::string_view() : value;
}

std::optional<long> number_in(const char* name) {
  const auto text = variable(name);
  long number = 0;
  const auto* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc() && read.ptr == end ? std::optional(number) : std::nullopt;
}

/// What is meant for another process was left over by the one that started this one.
bool is_for_us(const char* name) {
  const auto process = number_in(name);
  return process && *process == ::getpid();
}

/// Empty if there is none that can be used.
std::string notify_address() {
  std::string address(variable("NOTIFY_SOCKET"));
  const bool is_abstract = address.starts_with('@');
  if (address.size() >= sizeof sockaddr_un::sun_path) return {};
  if (!is_abstract && !address.starts_with('/')) return {};
  if (is_abstract) address[0] = '\0';
  return address;
}

tmcl::Duration watchdog() {
  if (!variable("WATCHDOG_PID").empty() && !is_for_us("WATCHDOG_PID")) return {};
  return std::chrono::microseconds(std::max(0L, number_in("WATCHDOG_USEC").value_or(0)));
}

int option_of(int descriptor, int option) {
  int value = 0;
  socklen_t size = sizeof value;
  return ::getsockopt(descriptor, SOL_SOCKET, option, &value, &size) == 0 ? value : -1;
}

bool is_listening_unix_socket(int descriptor) {
  return option_of(descriptor, SO_DOMAIN) == AF_UNIX &&
         option_of(descriptor, SO_TYPE) == SOCK_STREAM && option_of(descriptor, SO_ACCEPTCONN) == 1;
}

tl::expected<std::optional<int>, std::string> passed_socket() {
  const auto count = number_in("LISTEN_FDS").value_or(0);
  if (count <= 0 || !is_for_us("LISTEN_PID")) return std::nullopt;
  constexpr std::string_view what_to_try =
      "; have one ListenStream= in the socket's unit, the path that 'socket' in [daemon] names, "
      "and Accept=no";
  if (count > 1) {
    return tl::unexpected("tmcld was passed " + std::to_string(count) + " sockets, and serves one" +
                          std::string(what_to_try));
  }
  if (!is_listening_unix_socket(first_passed_descriptor))
    return tl::unexpected("what tmcld was passed is no unix socket that listens" +
                          std::string(what_to_try));
  ::fcntl(first_passed_descriptor, F_SETFD, FD_CLOEXEC);
  return first_passed_descriptor;
}

}  // namespace

tl::expected<Service, std::string> Service::of_environment() {
  auto socket = passed_socket();
  if (!socket) return tl::unexpected(std::move(socket.error()));
  Service service;
  service.socket_ = *socket;
  service.address_ = notify_address();
  if (service.address_.empty()) return service;
  service.descriptor_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  service.watchdog_ = watchdog();
  return service;
}

Service::Service(Service&& other) noexcept
    : address_(std::move(other.address_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      watchdog_(other.watchdog_),
      socket_(other.take_socket()) {}

Service& Service::operator=(Service&& other) noexcept {
  std::swap(address_, other.address_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(watchdog_, other.watchdog_);
  std::swap(socket_, other.socket_);
  return *this;
}

Service::~Service() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (socket_) ::close(*socket_);
}

tmcl::Duration Service::report_interval() const {
  constexpr tmcl::Duration unasked = std::chrono::seconds(1);
  return watchdog_ > tmcl::Duration{} ? watchdog_ / 2 : unasked;
}

void Service::alive() const {
  if (watchdog_ > tmcl::Duration{}) tell("WATCHDOG=1", Wait::no);
}

void Service::tell(const std::string& state, Wait wait) const {
  if (descriptor_ < 0) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(address_, address.sun_path);
  // The name of an abstract socket is as long as the address says, and zeros would belong to it.
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  const int flags = MSG_NOSIGNAL | (wait == Wait::yes ? 0 : MSG_DONTWAIT);
  // Nothing can be done about a manager that is not there: axes are served all the same.
  (void)::sendto(descriptor_, state.data(), state.size(), flags,
                 reinterpret_cast<const sockaddr*>(&address), size);
}

}  // namespace tmcld

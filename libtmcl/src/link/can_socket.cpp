#include "tmcl/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

namespace tmcl {
namespace {

std::string reason() { return std::generic_category().message(errno); }

ifreq named(const std::string& interface) {
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  return request;
}

std::string cannot_open() {
  if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
    return "this kernel has no CAN. Try: sudo modprobe can-raw (a container uses the kernel of its "
           "host, so load it there)";
  }
  return "cannot open a CAN socket: " + reason();
}

std::string no_interface(const std::string& interface) {
  return "there is no CAN interface '" + interface + "'. For a virtual one: sudo ip link add dev " +
         interface + " type vcan && sudo ip link set up " + interface;
}

std::string interface_down(const std::string& interface) {
  return "the CAN interface '" + interface + "' is down. Set it up: sudo ip link set up " +
         interface + " (a real controller needs its bit rate first: sudo ip link set " + interface +
         " type can bitrate 1000000)";
}

}  // namespace

tl::expected<FileDescriptor, std::string> open_can_socket(const std::string& interface) {
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket.valid()) return tl::unexpected(cannot_open());
  auto request = named(interface);
  if (interface.size() >= IFNAMSIZ || ::ioctl(socket.get(), SIOCGIFINDEX, &request) != 0) {
    return tl::unexpected(no_interface(interface));
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = request.ifr_ifindex;
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return tl::unexpected("cannot use '" + interface + "' for CAN: " + reason());
  }
  request = named(interface);
  const bool known = ::ioctl(socket.get(), SIOCGIFFLAGS, &request) == 0;
  if (known && (request.ifr_flags & IFF_UP) == 0) return tl::unexpected(interface_down(interface));
  return socket;
}

bool is_on(int socket, const std::string& interface) {
  sockaddr_can address{};
  socklen_t size = sizeof address;
  auto request = named(interface);
  return ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
         ::ioctl(socket, SIOCGIFINDEX, &request) == 0 && address.can_ifindex == request.ifr_ifindex;
}

CanRead read_can(int socket) {
  can_frame raw{};
  const auto size = ::read(socket, &raw, sizeof raw);
  if (size < 0) return {std::nullopt, errno};
  const bool data = size == sizeof raw && (raw.can_id & (CAN_RTR_FLAG | CAN_ERR_FLAG)) == 0;
  if (!data) return {};
  const bool extended = (raw.can_id & CAN_EFF_FLAG) != 0;
  CanFrame frame{raw.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK),
                 extended,
                 std::min<std::uint8_t>(raw.can_dlc, CAN_MAX_DLEN),
                 {}};
  std::copy_n(raw.data, frame.length, frame.data.begin());
  return {frame, 0};
}

bool write_can(int socket, const CanFrame& frame) {
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U);
  raw.can_dlc = frame.length;
  std::copy_n(frame.data.begin(), frame.length, raw.data);
  return ::write(socket, &raw, sizeof raw) == sizeof raw;
}

}  // namespace tmcl

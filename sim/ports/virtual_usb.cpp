#include "sim/ports/virtual_usb.hpp"

#include <fcntl.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

namespace tmcl::sim {
namespace {

namespace fs = std::filesystem;

const fs::path controller = "/sys/devices/platform/vhci_hcd.0";
constexpr int full_speed = 2;  // as linux/usb/ch9.h counts
constexpr int device_id = 1 << 16 | 1;

tl::unexpected<std::string> cannot(const std::string& why) {
  return tl::unexpected("cannot plug in a USB device: " + why);
}

// The driver has a root hub for each speed; this is the number of the slower one.
std::string number_of_bus() {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(controller, ignored)) {
    const auto name = entry.path().filename().string();
    if (!name.starts_with("usb")) continue;
    int speed = 0;
    std::ifstream(entry.path() / "speed") >> speed;
    if (speed == 480) return name.substr(3);
  }
  return "?";
}

/// What the kernel calls a device there.
std::string place_of(int socket) { return number_of_bus() + "-" + std::to_string(socket + 1); }

/// The kernel needs some tenths of a second to see that a cable was pulled. A device that is
/// plugged in before that stays the old one for it, and never works.
bool is_empty(int socket) {
  return !fs::exists(fs::path("/sys/bus/usb/devices") / place_of(socket));
}

/// A line for each socket: "hs  0000 004 000 00000000 000000 0-0".
std::optional<int> free_socket() {
  constexpr int is_free = 4;
  std::ifstream status(controller / "status");
  for (std::string line; std::getline(status, line);) {
    std::istringstream words(line);
    std::string hub;
    int socket = 0;
    int state = 0;
    if (words >> hub >> socket >> state && hub == "hs" && state == is_free && is_empty(socket))
      return socket;
  }
  return std::nullopt;
}

bool attach(int socket, int end) {
  const auto text = std::to_string(socket) + " " + std::to_string(end) + " " +
                    std::to_string(device_id) + " " + std::to_string(full_speed);
  const FileDescriptor file(::open((controller / "attach").c_str(), O_WRONLY | O_CLOEXEC));
  return file.valid() &&
         ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

}  // namespace

tl::expected<VirtualUsb, std::string> plug_in_virtual_usb() {
  if (!fs::exists(controller))
    return cannot("the kernel's driver for it is not loaded; try: sudo modprobe vhci-hcd");
  const auto socket = free_socket();
  if (!socket) return cannot("all sockets of the driver vhci-hcd are taken");
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    return cannot(std::strerror(errno));
  FileDescriptor own(ends[0]);
  const FileDescriptor of_kernel(ends[1]);
  if (!attach(*socket, of_kernel.get())) {
    const auto error = errno;
    const bool may_not = error == EACCES || error == EPERM;
    return cannot(may_not ? "that takes root; try sudo" : std::strerror(error));
  }
  return VirtualUsb{std::move(own), place_of(*socket)};
}

}  // namespace tmcl::sim

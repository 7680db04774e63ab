#include <algorithm>
#include <cerrno>
#include <fstream>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/epoll.h>
#include <sys/file.h>
#include <unistd.h>

#include "link/holder.hpp"
#include "link/opening.hpp"
#include "link/usb_port.hpp"
#include "tmcl/ports.hpp"

namespace tmcl {
namespace {

/// "usb:1-1.2 (2a3c:0100 Trinamic Motion Control Stepper Device)", for all that are modules.
std::vector<std::string> modules_among(const std::vector<Port>& ports) {
  std::vector<std::string> modules;
  for (const auto& port : ports) {
    if (!is_module(port)) continue;
    auto text = fmt::format("usb:{} ({})", port.usb->port, describe(*port.usb));
    if (std::ranges::find(modules, text) == modules.end()) modules.push_back(std::move(text));
  }
  return modules;
}

std::string what_is_there(const std::vector<std::string>& modules) {
  if (modules.empty())
    return "is a module plugged in, and has it power? 'tmclctl ports' lists what is there";
  return fmt::format("there is {}; 'tmclctl ports' lists all", fmt::join(modules, ", "));
}

Result<UsbDeviceInfo> find_device(const UsbName& name, const std::string& text,
                                  const std::vector<Port>& ports) {
  const auto modules = modules_among(ports);
  const auto is_meant = [&](const Port& port) {
    return name.port.empty() ? is_module(port) : port.usb && port.usb->port == name.port;
  };
  const auto found = std::ranges::find_if(ports, is_meant);
  if (name.port.empty() && modules.size() > 1) {
    return cannot_open(text,
                       fmt::format("several modules are on USB: {}", fmt::join(modules, ", ")),
                       "name the one that is meant");
  }
  if (found == ports.end()) {
    return cannot_open(
        text, name.port.empty() ? "no module is on USB" : "nothing there looks like a module",
        what_is_there(modules));
  }
  if (is_module(*found)) return *found->usb;
  return cannot_open(text, describe(*found->usb) + " is no TMCL module by its identifiers",
                     found->device.empty()
                         ? what_is_there(modules)
                         : "if it is one all the same, use its terminal: " + link_to(*found));
}

/// Whether any program has a terminal of the kernel's driver open, whosever it is; false where the
/// driver is not there, or does not count.
bool any_terminal_is_open() {
  int uses = 0;
  std::ifstream("/sys/module/cdc_acm/refcnt") >> uses;
  return uses > 0;
}

/// Of the terminals of a device: who has one open; empty if that cannot be told. A program of
/// another user cannot be found, but is counted: if no known program is meant by that, it may have
/// this terminal open.
std::optional<std::string> user_of_terminal(const std::string& usb_port,
                                            const std::vector<Port>& ports) {
  bool has_terminal = false;
  bool others_are_used = false;
  for (const auto& port : ports) {
    if (port.driver != "cdc_acm") continue;
    const bool is_meant = port.usb && port.usb->port == usb_port;
    auto holder = holder_of(port.device);
    if (is_meant && !holder.empty()) return holder;
    has_terminal = has_terminal || is_meant;
    others_are_used = others_are_used || !holder.empty();
  }
  if (has_terminal && !others_are_used && any_terminal_is_open())
    return "a program of another user";
  return std::nullopt;
}

std::string hint_for(int error, const UsbDeviceInfo& device) {
  if (error == EACCES || error == EPERM) {
    return fmt::format(
        "your user may not use the device: a udev rule gives it a group, such as "
        "SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{:04x}\", MODE=\"0660\", GROUP=\"dialout\" in "
        "/etc/udev/rules.d/60-tmcl.rules; then plug it in again",
        device.vendor);
  }
  if (error == ENOENT) return "unplugged just now? A container has to be given /dev/bus/usb";
  return {};
}

tl::unexpected<Error> refused(const std::string& text, const UsbDeviceInfo& device,
                              const Error& error) {
  if (error.code == Errc::link_busy) return busy(text, holder_of(device.node));
  if (error.code == Errc::bad_argument) {
    return cannot_open(
        text, describe(device) + " has no serial port by USB (CDC-ACM): no TMCL module", "");
  }
  return cannot_open(text, error.message, "plug the module out and in again");
}

}  // namespace

Result<Link> open_usb(const UsbName& name, const std::string& text) {
  const auto ports = list_ports();
  const auto device = find_device(name, text, ports);
  if (!device) return tl::unexpected(device.error());
  if (const auto user = user_of_terminal(device->port, ports)) return busy(text, *user);

  const int node = ::open(device->node.c_str(), O_RDWR | O_CLOEXEC);
  if (node < 0) {
    const int error = errno;
    return cannot_open(text, device->node + ": " + system_text(error), hint_for(error, *device));
  }
  // Tells others who has it.
  if (flock(node, LOCK_EX | LOCK_NB) != 0) {
    ::close(node);
    return busy(text, holder_of(device->node));
  }
  const int events = epoll_create1(EPOLL_CLOEXEC);
  if (events < 0) {
    const int error = errno;
    ::close(node);
    return cannot_open(text, system_text(error), "");
  }
  Link link(events, Framing::serial, text);
  auto port = open_usb_port(node, events);
  if (!port) return refused(text, *device, port.error());
  link.usb_ = std::move(*port);
  return link;
}

}  // namespace tmcl

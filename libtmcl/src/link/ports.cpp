#include "tmcl/ports.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "link/holder.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;

constexpr std::uint16_t trinamic = 0x2a3c;
// What modules had before their manufacturer had a number of its own. Evaluation boards with
// another USB adapter are not told from that adapter.
constexpr std::array<std::pair<std::uint16_t, std::uint16_t>, 6> older_modules{{
    {0x16d0, 0x0461},  // TMCM-1460
    {0x16d0, 0x05a1},  // TMCM-1161
    {0x16d0, 0x0650},  // TMCM-6110
    {0x16d0, 0x06cc},  // TMCM-3110
    {0x16d0, 0x07e4},  // Startrampe
    {0xf055, 0x9800},  // TMCM-0960
}};

/// The line that the kernel has for an attribute; empty if there is none. A device says what it
/// likes: nothing of that may control a terminal.
std::string attribute(const fs::path& path) {
  std::string line;
  std::ifstream file(path);
  std::getline(file, line);
  line.erase(line.find_last_not_of(" \t\r\n") + 1);
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = '?';
  return line;
}

std::uint16_t number_in(const fs::path& path, int base) {
  const auto text = attribute(path);
  std::uint16_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

bool is_present(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) entries.push_back(entry.path());
  std::ranges::sort(entries);
  return entries;
}

std::string name_behind(const fs::path& link) {
  std::error_code ignored;
  return fs::read_symlink(link, ignored).filename().string();
}

UsbDeviceInfo usb_device(const fs::path& folder) {
  UsbDeviceInfo device;
  device.port = folder.filename().string();
  device.vendor = number_in(folder / "idVendor", 16);
  device.product = number_in(folder / "idProduct", 16);
  device.manufacturer = attribute(folder / "manufacturer");
  device.product_name = attribute(folder / "product");
  device.serial = attribute(folder / "serial");
  device.node = fmt::format("/dev/bus/usb/{:03}/{:03}", number_in(folder / "busnum", 10),
                            number_in(folder / "devnum", 10));
  return device;
}

/// The USB device that this is a part of.
std::optional<UsbDeviceInfo> usb_device_around(fs::path folder) {
  for (; folder.has_relative_path(); folder = folder.parent_path())
    if (is_present(folder / "idVendor")) return usb_device(folder);
  return std::nullopt;
}

/// Serial ports that the computer could have, and has not, are listed by the kernel, too.
bool is_there(const fs::path& terminal) {
  const bool is_hardware = is_present(terminal / "device");
  return is_hardware && attribute(terminal / "type") != "0";
}

std::string stable_name(const fs::path& root, const std::string& device) {
  for (const auto* folder : {"dev/tmcl/by-path", "dev/serial/by-path"})
    for (const auto& link : entries_of(root / folder))
      if (name_behind(link) == device) return "/" + link.lexically_relative(root).string();
  return {};
}

Port port_of(const fs::path& root, const fs::path& terminal) {
  const auto name = terminal.filename().string();
  std::error_code ignored;
  const auto hardware = fs::canonical(terminal / "device", ignored);
  return {"/dev/" + name, name_behind(hardware / "driver"), stable_name(root, name),
          usb_device_around(hardware)};
}

/// By the class of its interfaces: what the kernel's cdc_acm makes a terminal of.
bool is_serial_port(const fs::path& device) {
  return std::ranges::any_of(entries_of(device), [](const fs::path& interface) {
    return attribute(interface / "bInterfaceClass") == "02" &&
           attribute(interface / "bInterfaceSubClass") == "02";
  });
}

}  // namespace

bool is_module(const UsbDeviceInfo& device) {
  return device.vendor == trinamic ||
         std::ranges::find(older_modules, std::pair(device.vendor, device.product)) !=
             older_modules.end();
}

bool is_module(const Port& port) { return port.usb && is_module(*port.usb); }

std::string describe(const UsbDeviceInfo& device) {
  auto text = fmt::format("{:04x}:{:04x}", device.vendor, device.product);
  for (const auto& word : {device.manufacturer, device.product_name})
    if (!word.empty()) text += " " + word;
  return text;
}

std::string link_to(const Port& port) {
  return port.device.empty() ? "usb:" + port.usb->port : "serial:" + port.device;
}

std::vector<Port> list_ports(const fs::path& root) {
  std::vector<Port> ports;
  for (const auto& terminal : entries_of(root / "sys/class/tty"))
    if (is_there(terminal)) ports.push_back(port_of(root, terminal));
  for (const auto& folder : entries_of(root / "sys/bus/usb/devices")) {
    if (!is_present(folder / "idVendor")) continue;
    auto device = usb_device(folder);
    const bool is_listed = std::ranges::any_of(
        ports, [&](const Port& port) { return port.usb && port.usb->port == device.port; });
    if (!is_listed && (is_module(device) || is_serial_port(folder)))
      ports.push_back({{}, {}, {}, std::move(device)});
  }
  return ports;
}

std::string holder_of(const Port& port) {
  auto holder = port.device.empty() ? std::string{} : holder_of(port.device);
  return holder.empty() && port.usb ? holder_of(port.usb->node) : holder;
}

}  // namespace tmcl

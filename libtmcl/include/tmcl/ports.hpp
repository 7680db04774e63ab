/// Serial ports and USB devices of this computer that may be modules, as the kernel lists them.
/// Nothing is opened, so no other program is disturbed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tmcl {

struct UsbDeviceInfo {
  std::string port;  ///< "1-1.2": where it is plugged in.
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string manufacturer;  ///< What the device says; it and the next two may be empty.
  std::string product_name;
  std::string serial;  ///< All modules may say the same here.
  std::string node;    ///< "/dev/bus/usb/001/004", by which programs reach it without a driver.
};

struct Port {
  std::string device;  ///< "/dev/ttyACM0"; empty for a USB device that has no serial port now.
  std::string driver;
  std::string by_path;               ///< A name of the device that stays; empty if it has none.
  std::optional<UsbDeviceInfo> usb;  ///< What is behind a port on USB.
};

/// Whether its identifiers are those of modules by Trinamic.
bool is_module(const UsbDeviceInfo& device);
bool is_module(const Port& port);

/// "2a3c:0100 Trinamic Motion Control Stepper Device"
std::string describe(const UsbDeviceInfo& device);
/// The link that leads there, "serial:/dev/ttyACM0" or "usb:1-1.2".
std::string link_to(const Port& port);

/// Ordered by name. Devices by USB that have no serial port are there if they are modules, or
/// serial ports without a driver. `root` has the folders sys and dev.
std::vector<Port> list_ports(const std::filesystem::path& root = "/");

/// The program that has it open: "tmcld (process 4711)". Empty if there is none, or if it cannot be
/// found, for instance because it belongs to another user.
std::string holder_of(const Port& port);

}  // namespace tmcl

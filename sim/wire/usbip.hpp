/// The USB/IP protocol, by which a program is a device of Linux' vhci-hcd: bytes and commands.
/// As the kernel's documentation has it, usb/usbip_protocol.rst.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "sim/wire/usb_device.hpp"

namespace tmcl::sim {

/// The host does not want the result of a request any more.
struct UsbipCancel {
  std::uint32_t id = 0;       ///< Of this command.
  std::uint32_t request = 0;  ///< What is meant.
};

/// Makes commands of a stream of bytes.
class UsbipDecoder {
 public:
  using Command = std::variant<UsbRequest, UsbipCancel>;

  /// A transfer of more bytes than that is no USB device's of this kind.
  static constexpr std::uint32_t longest_transfer = 1 << 20;

  void feed(std::span<const std::uint8_t> bytes);
  /// The next command that is whole.
  std::optional<Command> next();
  /// It is not USB/IP, and nothing after that can be read.
  bool is_broken() const { return is_broken_; }

 private:
  std::vector<std::uint8_t> bytes_;
  bool is_broken_ = false;
};

std::vector<std::uint8_t> encode_usbip(const UsbResult& result);
/// `in_time`: the request was still waiting, and gets no result.
std::vector<std::uint8_t> encode_usbip(const UsbipCancel& cancel, bool in_time);

}  // namespace tmcl::sim

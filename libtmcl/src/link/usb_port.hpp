/// The USB port of a module, as a stream of bytes. The file beside this is all that knows libusb.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "tmcl/error.hpp"

namespace tmcl {

/// Gives the device back to the kernel's driver at its end, unless the link broke. Nothing here
/// waits, but for that.
class UsbPort {
 public:
  virtual ~UsbPort() = default;
  /// What has come in; 0 if there is nothing now. An error is a sentence, and the end of the port.
  virtual tl::expected<std::size_t, std::string> read(std::span<std::uint8_t> into) = 0;
  /// All of a datagram in one transfer, which the device takes within 50 ms or never; 0 as
  /// long as it may still take the one before.
  virtual tl::expected<std::size_t, std::string> write(std::span<const std::uint8_t> bytes) = 0;
};

/// Takes the device from the kernel's driver, even if a program has its terminal open. Blocks
/// for as long as the device takes to answer. `node`: a descriptor of /dev/bus/usb/..., which the
/// port closes. `events`: one of epoll, not taken over, which becomes readable when something
/// happens. Errors: link_busy, if another program uses it without that driver; bad_argument of one
/// that has no interfaces such as modules have; otherwise link_open_failed, with why.
Result<std::shared_ptr<UsbPort>> open_usb_port(int node, int events);

}  // namespace tmcl

/// A USB socket that this computer does not have: the kernel's driver vhci-hcd, by USB/IP.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "tmcl/file_descriptor.hpp"

namespace tmcl::sim {

/// A cable in such a socket. When its end is closed, the kernel sees the device go.
struct VirtualUsb {
  FileDescriptor end;  ///< USB/IP, a stream of bytes.
  std::string place;   ///< As the kernel calls it, such as "3-1".
};

/// Plugs a device of full speed into the first free socket. Needs root and vhci-hcd; the error is a
/// sentence that says what to do.
tl::expected<VirtualUsb, std::string> plug_in_virtual_usb();

}  // namespace tmcl::sim

/// Where a bus is, as a person writes it.
///
///     serial:/dev/ttyACM0@115200      (without @: 9600 baud, what a new module speaks)
///     can:can0
///     tcp:127.0.0.1:4001              (also tcp:[::1]:4001 and tcp:name:4001)
///     usb:1-1.2                       (the kernel's name of the place where it is plugged in)
///     usb:auto                        (the only module by USB that there is)
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "tmcl/error.hpp"

namespace tmcl {

struct SerialName {
  std::string device;
  std::uint32_t baud = 9600;  ///< 50..4000000
};
struct CanName {
  std::string interface;
};
struct TcpName {
  std::string host;
  std::uint16_t port = 0;  ///< 1..65535
};

struct UsbName {
  std::string port;  ///< "1-1.2": bus 1, port 1 of the computer, port 2 of a hub; empty: auto.
};

using LinkName = std::variant<SerialName, CanName, TcpName, UsbName>;

/// Errors: Errc::bad_argument, naming what is wrong and the nearest kind of link.
Result<LinkName> parse_link_name(std::string_view text);
std::string to_string(const LinkName& name);

}  // namespace tmcl

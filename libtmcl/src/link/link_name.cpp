#include "tmcl/link_name.hpp"

#include <array>

#include <fmt/format.h>

#include "core/text.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl {
namespace {

constexpr std::array<std::string_view, 4> kinds{"serial", "can", "tcp", "usb"};
constexpr auto how_to =
    "a link is serial:DEVICE[@BAUD], usb:PORT, usb:auto, can:INTERFACE or tcp:HOST:PORT";
constexpr std::uint32_t lowest_baud = 50;
constexpr std::uint32_t highest_baud = 4'000'000;
constexpr std::size_t longest_interface = 15;  // IFNAMSIZ - 1
constexpr std::size_t longest_usb_port = 31;   // hubs behind hubs: no more than five

tl::unexpected<Error> bad_link(std::string_view text, std::string_view what) {
  return tl::unexpected(bad_argument(fmt::format("'{}' is no link: {}", text, what), how_to));
}

Result<LinkName> parse_serial(std::string_view text, std::string_view rest) {
  SerialName name;
  // The last @: device names may contain one.
  const auto at = rest.rfind('@');
  name.device = rest.substr(0, at);
  if (name.device.empty()) return bad_link(text, "the device is missing");
  if (at == std::string_view::npos) return name;
  const auto baud = text::parse_integer<std::uint32_t>(rest.substr(at + 1));
  if (!baud || *baud < lowest_baud || *baud > highest_baud) {
    return bad_link(text, fmt::format("the baud rate must be a number from {} to {}", lowest_baud,
                                      highest_baud));
  }
  name.baud = *baud;
  return name;
}

Result<LinkName> parse_can(std::string_view text, std::string_view rest) {
  if (rest.empty()) return bad_link(text, "the interface is missing");
  const auto at = rest.rfind('@');
  if (at != std::string_view::npos && text::parse_integer<std::uint32_t>(rest.substr(at + 1))) {
    return bad_link(text,
                    fmt::format("the bit rate is set with `ip link set {} type can bitrate {}`",
                                rest.substr(0, at), rest.substr(at + 1)));
  }
  if (rest.size() > longest_interface)
    return bad_link(text, "an interface's name has at most 15 characters");
  return CanName{std::string(rest)};
}

Result<LinkName> parse_tcp(std::string_view text, std::string_view rest) {
  const auto colon = rest.rfind(':');
  if (colon == std::string_view::npos) return bad_link(text, "the port is missing");
  auto host = rest.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  if (host.empty()) return bad_link(text, "the host is missing");
  const auto port = text::parse_integer<std::uint16_t>(rest.substr(colon + 1));
  if (!port || *port == 0) return bad_link(text, "the port must be a number from 1 to 65535");
  return TcpName{std::string(host), *port};
}

/// Nothing but digits with a '-', then '.', between them: it becomes part of a file's name.
bool is_usb_port(std::string_view text) {
  if (text.size() > longest_usb_port) return false;
  const auto dash = text.find('-');
  const auto is_number = [](std::string_view part) {
    return text::parse_integer<std::uint8_t>(part).has_value();
  };
  if (dash == std::string_view::npos || !is_number(text.substr(0, dash))) return false;
  for (auto rest = text.substr(dash + 1);;) {
    const auto dot = rest.find('.');
    if (!is_number(rest.substr(0, dot))) return false;
    if (dot == std::string_view::npos) return true;
    rest = rest.substr(dot + 1);
  }
}

Result<LinkName> parse_usb(std::string_view text, std::string_view rest) {
  if (rest == "auto") return UsbName{};
  if (is_usb_port(rest)) return UsbName{std::string(rest)};
  return bad_link(text,
                  "behind usb: comes auto, or the kernel's name of a port such as 1-1.2; "
                  "'tmclctl ports' lists them");
}

}  // namespace

Result<LinkName> parse_link_name(std::string_view text) {
  // A device alone, as everybody calls it; its name may have a colon.
  if (text.starts_with('/')) return parse_serial(text, text);
  const auto colon = text.find(':');
  const auto kind = text.substr(0, colon);
  if (colon == std::string_view::npos)
    return bad_link(text, "it does not begin with a kind and a colon");
  const auto rest = text.substr(colon + 1);
  if (kind == "serial") return parse_serial(text, rest);
  if (kind == "can") return parse_can(text, rest);
  if (kind == "tcp") return parse_tcp(text, rest);
  if (kind == "usb") return parse_usb(text, rest);
  return bad_link(text, fmt::format("there is no kind '{}'.{}", kind, did_you_mean(kind, kinds)));
}

std::string to_string(const LinkName& name) {
  if (const auto* serial = std::get_if<SerialName>(&name))
    return fmt::format("serial:{}@{}", serial->device, serial->baud);
  if (const auto* can = std::get_if<CanName>(&name)) return "can:" + can->interface;
  if (const auto* usb = std::get_if<UsbName>(&name))
    return "usb:" + (usb->port.empty() ? "auto" : usb->port);
  const auto& tcp = std::get<TcpName>(name);
  const bool is_ipv6 = tcp.host.find(':') != std::string::npos;
  return is_ipv6 ? fmt::format("tcp:[{}]:{}", tcp.host, tcp.port)
                 : fmt::format("tcp:{}:{}", tcp.host, tcp.port);
}

}  // namespace tmcl

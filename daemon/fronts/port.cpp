#include "fronts/port.hpp"

#include <poll.h>

#include <type_traits>
#include <utility>
#include <variant>

#include "fronts/port_stream.hpp"

namespace tmcld {

bool has_input(int descriptor) {
  pollfd entry{descriptor, POLLIN, 0};
  return ::poll(&entry, 1, 0) > 0;
}

bool asks_for_stop(std::span<const std::uint8_t> bytes) {
  bool asks = false;
  PortFramer framer;
  framer.push(bytes, [&](const tmcl::SerialBytes& datagram) {
    const auto request = tmcl::decode_serial_request(datagram);
    asks = asks || (request && is_stop(intent_of(*request)));
  });
  return asks;
}

tl::expected<std::shared_ptr<Port>, std::string> open_port(const PortConfig& config,
                                                           std::shared_ptr<Gateway> gateway) {
  auto port = std::visit(
      [&](const auto& name) {
        using Name = std::decay_t<decltype(name)>;
        if constexpr (std::is_same_v<Name, PtyName>) return open_pty_port(config, name, gateway);
        if constexpr (std::is_same_v<Name, tmcl::TcpName>)
          return open_tcp_port(config, name, gateway);
        if constexpr (std::is_same_v<Name, tmcl::CanName>)
          return open_can_port(config, name, gateway);
      },
      config.place);
  if (!port) return tl::unexpected("port '" + config.name + "': " + port.error());
  return port;
}

}  // namespace tmcld

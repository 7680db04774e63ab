/// Serial lines over TCP, as a serial device server offers them: the nine bytes, and nothing else.
#pragma once

#include <cstddef>

#include <boost/asio/io_context.hpp>

#include "sim/ports/endpoint.hpp"
#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/serial_wire.hpp"

namespace tmcl::sim {

constexpr std::size_t most_tcp_clients = 32;  ///< Further connections are closed at once.

/// Listens on HOST:PORT, such as "127.0.0.1:4001" or "[::1]:4001"; port 0 takes any that is free,
/// and the description tells which. Each client has a line of its own to the same modules. A client
/// that does not take its replies is disconnected.
OpenedPort open_tcp_port(boost::asio::io_context& io, Scheduler& scheduler,
                         const Endpoint& endpoint, const SerialWire& wire = {});

}  // namespace tmcl::sim

/// A serial line, or the USB port of one module, on a pseudo terminal.
#pragma once

#include <cstdint>
#include <filesystem>

#include <boost/asio/io_context.hpp>

#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/serial_wire.hpp"

namespace tmcl::sim {

/// Makes `path` a link to a new pseudo terminal, until the port goes. Hosts may open and close it
/// as often as they like. Replies that no host takes are lost, as on a real line. Where modules
/// have rates, the host's is the one that it has set on the terminal.
OpenedPort open_pty_port(boost::asio::io_context& io, Scheduler& scheduler,
                         const std::filesystem::path& path, const SerialWire& wire = {});
/// The same. What a host has written when it is read is taken for one packet: a pseudo terminal
/// does not keep them apart.
OpenedPort open_usb_pty_port(boost::asio::io_context& io, Scheduler& scheduler, Module& module,
                             const std::filesystem::path& path, std::uint64_t seed);

}  // namespace tmcl::sim

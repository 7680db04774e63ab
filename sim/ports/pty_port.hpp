/// A serial line on a pseudo terminal.
#pragma once

#include <filesystem>

#include <boost/asio/io_context.hpp>

#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"

namespace tmcl::sim {

/// Makes `path` a link to a new pseudo terminal, until the port goes. Hosts may open and close it
/// as often as they like. Replies that no host takes are lost, as on a real line.
OpenedPort open_pty_port(boost::asio::io_context& io, Scheduler& scheduler,
                         const std::filesystem::path& path);

}  // namespace tmcl::sim

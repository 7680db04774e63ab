/// A CAN bus through a SocketCAN interface.
#pragma once

#include <string>

#include <boost/asio/io_context.hpp>

#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/pace.hpp"

namespace tmcl::sim {

/// Puts the modules on the bus of an interface that exists and is up, such as "can0" or "vcan0".
/// Survives that the interface goes down and comes up again, or is deleted and made anew; that it
/// is gone, and there again, is said on standard error.
OpenedPort open_can_port(boost::asio::io_context& io, Scheduler& scheduler,
                         const std::string& interface, Pace pace = {});

}  // namespace tmcl::sim

/// One end of a pair of sockets, whose other end a host in the same process has.
#pragma once

#include <memory>

#include <boost/asio/io_context.hpp>

#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/pace.hpp"
#include "sim/wire/serial_wire.hpp"
#include "tmcl/file_descriptor.hpp"

namespace tmcl::sim {

/// A serial line on a stream. Replies that the host has no room for are lost.
std::unique_ptr<Port> serve_serial_socket(boost::asio::io_context& io, Scheduler& scheduler,
                                          FileDescriptor socket, const SerialWire& wire);
/// A CAN bus on a socket whose packets are each one struct can_frame; the same.
std::unique_ptr<Port> serve_can_socket(boost::asio::io_context& io, Scheduler& scheduler,
                                       FileDescriptor socket, Pace pace);

}  // namespace tmcl::sim

/// A module as a USB device of this computer, which its drivers take for a real one.
#pragma once

#include <cstdint>

#include <boost/asio/io_context.hpp>

#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/usb_layout.hpp"

namespace tmcl::sim {

/// The device is gone when the port is. How long answers take is drawn from the seed.
OpenedPort open_usb_port(boost::asio::io_context& io, Scheduler& scheduler, Module& module,
                         UsbLayout layout, std::uint64_t seed);

}  // namespace tmcl::sim

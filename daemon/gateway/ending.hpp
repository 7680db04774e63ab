/// How a gateway ends: nothing is left moving that needs supervision.
#pragma once

#include <chrono>
#include <memory>

#include <boost/asio/awaitable.hpp>

#include "gateway/gateway.hpp"

namespace tmcld {

/// Stops are on their way for well below a second.
constexpr tmcl::Duration time_for_stops = std::chrono::milliseconds(300);
/// Axes brake as they are set up to; those on lines and paths then get their settings back.
constexpr tmcl::Duration time_to_stand = std::chrono::seconds(12);
/// An image of 240 kB takes about half of it at 115200 baud. A module whose upload is cut short has
/// no firmware.
constexpr tmcl::Duration time_for_uploads = std::chrono::seconds(300);

/// Admits nothing but stops from now on. Leases are lost, axes on lines and paths are stopped and
/// get their settings back; with OnExit::stop whatever else moves is stopped, too. Firmware uploads
/// come to their end, stops on their way are given a moment; then the buses are closed, and
/// whatever else is in progress ends with Errc::link_lost.
boost::asio::awaitable<void> end_gateway(std::shared_ptr<Gateway> gateway);

}  // namespace tmcld

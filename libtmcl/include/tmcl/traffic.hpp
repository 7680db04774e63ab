/// What goes over a bus, for listeners: every byte, whatever it means.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "tmcl/clock.hpp"

namespace tmcl {

struct Traffic {
  enum class Direction : std::uint8_t { out, in };

  TimePoint at{};
  Direction direction = Direction::out;
  /// CAN: of the frame.
  std::uint32_t can_id = 0;
  bool can_extended = false;
  /// What was written or read at once: on CAN the data of a frame, on a serial line a request, or
  /// any bytes that came in. Valid during the call only.
  std::span<const std::uint8_t> bytes{};
  /// Of a request: CallOptions::asker of the call that it is for; 0 of what the bus itself asks.
  std::uint64_t asker = 0;
};

using OnTraffic = std::function<void(const Traffic&)>;

}  // namespace tmcl

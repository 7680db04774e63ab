/// Recorded traffic of a bus, as a file that Wireshark reads (pcapng).
///
/// The packets have the link type USER0 and begin with five bytes before those that were on the
/// wire:
///
///     flags          1: from the modules, 2: a CAN frame, 4: of 29 bits, 8: belongs to no datagram
///     CAN identifier four bytes, most significant first; 0 on a serial line
///
/// Who asked is the comment of a packet, and the name of the bus that of the interface.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/traffic.hpp"

namespace tmcl {

struct TracedDatagram {
  UtcTime at{};  ///< To the microsecond.
  Traffic::Direction direction = Traffic::Direction::out;
  bool on_can = false;
  bool can_extended = false;
  bool is_garbage = false;  ///< It belongs to no datagram.
  std::uint32_t can_id = 0;
  std::vector<std::uint8_t> bytes{};
  std::string client{};  ///< The client that asked; empty: the bus itself, or unknown.

  bool operator==(const TracedDatagram&) const = default;
};

struct Trace {
  std::string bus;
  std::vector<TracedDatagram> datagrams;
};

/// What a file begins with; packets follow, one after the other. Without the name of a bus it has
/// none.
std::string trace_file_header(std::string_view bus);
std::string trace_file_packet(const TracedDatagram& datagram);

/// Takes what trace_file_header() and trace_file_packet() write, and what other programs make of
/// that: packets of other link types are left out. Errors: at which byte of the file what is wrong.
tl::expected<Trace, std::string> parse_trace_file(std::string_view contents);
/// The same of a file. Errors: the same, with the name of the file; or why it cannot be read.
tl::expected<Trace, std::string> read_trace_file(const std::string& path);

/// As it was on CAN: its first eight bytes.
CanFrame can_frame_of(const TracedDatagram& datagram);
/// Nothing if its bytes are no reply.
std::optional<Reply> reply_of(const TracedDatagram& datagram);

/// Of a request or of a reply; nothing of other bytes.
std::optional<Command> command_of(const TracedDatagram& datagram);

/// What it means, for people: "1 MVP ABS 51200 motor 0" or "1 MVP invalid_value (4) 0", which begin
/// with the address of the module. Axis parameters have names where they are in `parameters`.
std::string describe(const TracedDatagram& datagram,
                     std::span<const ParameterInfo> parameters = {});

}  // namespace tmcl

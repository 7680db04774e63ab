/// A question for a serial line whose baud rate is not known.
///
/// A module that listens at another rate hears other bytes than were sent. By chance they could be
/// a datagram that moves a motor. This question cannot become one: whatever rate of its own a
/// module has, no nine bytes in a row that it hears are, with a right checksum, a command that
/// moves a motor or changes anything. They may be a stop, or a command that TMCL does not define:
/// without these there is no question for some addresses. GET_FIRMWARE_VERSION ignores two fields,
/// motor and value; they are chosen for that, by a model of the receiver.
///
/// The model: eight bits, no parity, one stop bit; a receiver begins at a falling edge and looks at
/// the middle of each bit. Where it finds no stop bit it may drop the byte or keep it, and may wait
/// until the line is high or begin at once: the question is harmless to all four. Its bytes follow
/// each other without a gap. Between two questions the line must be silent for more than 5 ms,
/// after which modules forget what they have begun to hear.
///
/// Does no I/O.
#pragma once

#include <array>
#include <cstdint>

#include "tmcl/datagram.hpp"

namespace tmcl {

/// Those that modules have, in bits per second: the codes of global parameter 65.
inline constexpr std::array<std::uint32_t, 12> serial_rates{9'600,   14'400,  19'200,  28'800,
                                                            38'400,  57'600,  76'800,  115'200,
                                                            230'400, 250'000, 500'000, 1'000'000};

/// Asks for the firmware's version in its binary form. `address`: 1..255; `rate`: one of
/// serial_rates, at which it is sent. Takes about half a millisecond.
SerialBytes harmless_question(std::uint8_t address, std::uint32_t rate);

}  // namespace tmcl

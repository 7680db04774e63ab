/// How fast the wire of a link is.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/link_name.hpp"

namespace tmcl {

/// Bits a second: as the name says for a serial line, as its controller is set for CAN (asked of
/// the kernel by rtnetlink, which answers at once). Nothing where it is unknown: virtual CAN, TCP,
/// USB, also where that is a terminal, whose baud rate means nothing.
std::optional<std::uint32_t> bit_rate_of(const LinkName& link);

}  // namespace tmcl

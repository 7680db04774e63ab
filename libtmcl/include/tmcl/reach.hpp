/// What takes a module out of the reach of the host that talks to it: the next request would not be
/// understood, or its answer not be heard. A motor that turns then is stopped by nothing that the
/// host can send.
///
/// One table (src/core/reach.cpp) is the only place where this is written down.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "tmcl/bus_options.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/link.hpp"

namespace tmcl {

/// How a host talks to its modules.
struct Reach {
  Framing framing = Framing::serial;
  /// First byte of the replies that it listens to, and the identifier of those on CAN.
  std::uint8_t host_address = default_host_address;
  std::uint32_t can_reply_id = default_can_reply_id;
  /// How long a module may wait before it answers.
  Duration longest_pause{};
};

/// Why a request would end that, in a form that follows "the module"; nothing if it would not, as
/// far as the request tells. What a program in a module does, the request does not tell.
std::optional<std::string_view> loss_of_reach(const Request& request, const Reach& reach);

}  // namespace tmcl

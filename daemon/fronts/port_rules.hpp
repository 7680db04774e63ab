/// What a host at a port may do, and what it is told: as a module would, or nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "config/config.hpp"
#include "tmcl/script.hpp"
#include "tmcl/version.hpp"

namespace tmcld {

/// In which form a host asks on CAN: it is answered in the same one.
struct CanForm {
  bool extended = false;
  std::uint8_t length = tmcl::can_datagram_size;
};

/// What a host is told.
struct Told {
  tmcl::Reply reply{};
  /// Where a module says its version as text: that takes the place of the reply.
  std::optional<tmcl::FirmwareVersion> text{};
};

tmcl::SerialBytes to_serial(const Told& told);
/// The identifier is that of the replies.
tmcl::CanFrame to_can(const Told& told, std::uint32_t identifier, CanForm form);

/// The role that a port must have for a request: `operate` where the configuration says "move",
/// `configure` where it says that. A stop needs none.
Role role_at_port(const tmcl::Request& request);

/// Whether a module would say nothing: it, its link or this daemon had no answer in time.
bool is_silence(const tmcl::Error& error);

/// What a module says that does not do it: command not available.
tmcl::Reply refusal_at_port(const tmcl::Request& request, std::uint8_t host);
/// What a module says to a datagram with a wrong checksum.
tmcl::Reply wrong_checksum(tmcl::ModuleAddress module, std::uint8_t host);

/// What the host is told about how its request has ended; nothing: silence. `host`: the address of
/// hosts, as the module has it; `heard`: the last reply on the bus that was for this host.
std::optional<Told> told_about(const tmcl::Request& request,
                               const tmcl::Result<tmcl::Answer>& answer, std::uint8_t host,
                               const std::optional<tmcl::Reply>& heard);

}  // namespace tmcld

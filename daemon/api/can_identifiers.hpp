/// The identifiers that modules on a CAN bus listen to, and that of their replies: they must
/// differ.
#pragma once

#include <optional>

#include "api/error.hpp"
#include "gateway/bus.hpp"

namespace tmcld {

/// Whether a command would make a module on this bus take replies for commands, as far as that is
/// known here. Nothing is asked.
std::optional<Error> identifier_conflict(const GatewayBus& bus, const tmcl::Request& request);

/// A module whose address is the identifier of the bus' replies executes each of them.
bool has_address_of_replies(const GatewayBus& bus, tmcl::ModuleAddress module);

}  // namespace tmcld

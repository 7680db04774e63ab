/// What would take a module out of the reach of its bus.
#pragma once

#include <optional>

#include "gateway/bus.hpp"
#include "tmcl/program.hpp"

namespace tmcld {

/// Errc::not_permitted for such a request: nothing on this bus could stop the module's motors any
/// more. Nothing is asked.
std::optional<tmcl::Error> loss_of_reach(const GatewayBus& bus, const tmcl::Request& request);

/// The same, as long as a motor of the module may move.
std::optional<tmcl::Error> loss_of_moving_motor(const GatewayBus& bus,
                                                const tmcl::Request& request);

/// The same of the first line of a program for this module that would do that when it runs.
std::optional<tmcl::Error> loss_by_program(const GatewayBus& bus, tmcl::ModuleAddress module,
                                           const tmcl::program::Program& program,
                                           std::size_t first_address);

}  // namespace tmcld

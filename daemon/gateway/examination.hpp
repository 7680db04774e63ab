/// Looks for what keeps axes from moving: what a person asks in front of the machine, asked of the
/// modules. Nothing is set; the flags that reading clears are kept as the cause of a stop.
#pragma once

#include <memory>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/axis/axis.hpp"
#include "tmcl/doctor.hpp"

namespace tmcld {

class Gateway;

using Findings = std::vector<tmcl::Finding>;

/// What is looked at: buses, the modules on them that are configured, and axes.
struct Examined {
  std::vector<std::shared_ptr<GatewayBus>> buses{};
  std::vector<std::shared_ptr<GatewayAxis>> axes{};
  std::uint64_t client = 0;  ///< Who asks.
};

/// In the order of the checks; also what is as it should be. What cannot be asked is not found.
boost::asio::awaitable<Findings> examine(std::shared_ptr<Gateway> gateway, Examined what);

}  // namespace tmcld

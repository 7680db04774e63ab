/// A stop for everything that could move.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/gateway.hpp"

namespace tmcld {

struct StopReport {
  std::string axis;
  tmcl::Result<void> result;
  tmcl::Duration took{};  ///< Until its module had confirmed.
};

/// Stops all axes, every other motor of their modules, and motors that raw commands have moved. All
/// of them lose the right to move before the first stop is on its way. Each takes one exchange,
/// those that may move first and modules in turn; an axis that searches its reference takes one
/// more, behind all others. Then the programs of the modules are ended: see program_end.hpp. No
/// stop waits for a module that was silent before: on a serial line it is told when all others
/// were. `client`: who asks.
boost::asio::awaitable<std::vector<StopReport>> stop_all(std::shared_ptr<Gateway> gateway,
                                                         std::uint64_t client = 0);

}  // namespace tmcld

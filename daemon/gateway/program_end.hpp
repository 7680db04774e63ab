/// The end of programs that modules run by themselves.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <boost/asio/awaitable.hpp>

#include "gateway/bus.hpp"

namespace tmcld {

/// A module whose motors are told to stop.
struct StoppedModule {
  std::shared_ptr<GatewayBus> bus;
  tmcl::ModuleAddress address{};
  std::vector<tmcl::AxisAddress> motors{};
  /// To one of these stops, or to another command just before. One that has not is asked nothing:
  /// the end of its program is owed at once.
  bool has_answered = false;
};

/// Ends the program of the module, and the searches that it may have begun: true if it may have
/// run, so that its motors are to be stopped once more. A module that runs none is asked for that
/// only. What was not answered is owed, and the stops of the motors with it. `client`: who asks.
/// Errors: those of the exchanges.
boost::asio::awaitable<tmcl::Result<bool>> end_program(StoppedModule module, std::uint64_t client);

}  // namespace tmcld

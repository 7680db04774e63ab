/// Modules as methods name them: a bus and an address, whether an axis is configured there or not.
#pragma once

#include <utility>

#include "api/lookup.hpp"

namespace tmcld {

struct ModuleChoice {
  std::shared_ptr<GatewayBus> bus;
  tmcl::ModuleAddress address{};
};

/// The parameters "bus" and "address".
Lookup<ModuleChoice> module_of(const Call& call);

/// What is known about the module is old now.
void expect_news(const ModuleChoice& module);

/// Runs a verb on a module, within the call's deadline.
template <class T>
boost::asio::awaitable<Lookup<T>> run_on(const ModuleChoice& module, const Call& call,
                                         tmcl::Script<tmcl::Result<T>> script) {
  RunOptions options;
  options.deadline = call.deadline();
  options.permit = call.permit;
  auto result = co_await module.bus->run(std::move(script), std::move(options));
  if (result) {
    if constexpr (std::is_void_v<T>) {
      co_return Lookup<T>{};
    } else {
      co_return std::move(*result);
    }
  }
  if (result.error().bus.empty()) result.error().bus = module.bus->name();
  co_return tl::unexpected(call_error(result.error()));
}

}  // namespace tmcld

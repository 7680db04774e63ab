#include "api/module_choice.hpp"

namespace tmcld {

Lookup<ModuleChoice> module_of(const Call& call, const api::OnModule& params, Deadline deadline) {
  return bus_of(call, params.bus).map([&](std::shared_ptr<GatewayBus> bus) {
    return ModuleChoice{std::move(bus), address_of(params), deadline};
  });
}

void expect_news(const ModuleChoice& module) {
  auto* known = module.bus->find_module(module.address);
  if (known != nullptr) known->forget_state();
}

boost::asio::awaitable<Lookup<api::Nothing>> act_on(const Call& call, Lookup<ModuleChoice> module,
                                                    tmcl::Script<tmcl::Result<void>> script,
                                                    bool news) {
  if (!module) co_return tl::unexpected(std::move(module.error()));
  auto done = co_await run_on(*module, call, std::move(script));
  if (news) expect_news(*module);
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return api::Nothing{};
}

}  // namespace tmcld

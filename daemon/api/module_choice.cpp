#include "api/module_choice.hpp"

namespace tmcld {

Result<ModuleChoice> module_of(const Call& call, const api::OnModule& params, Deadline deadline) {
  return bus_of(call, params.bus).map([&](std::shared_ptr<GatewayBus> bus) {
    return ModuleChoice{std::move(bus), address_of(params), deadline};
  });
}

void expect_news(const ModuleChoice& module) {
  auto* known = module.bus->find_module(module.address);
  if (known != nullptr) known->forget_state();
}

Task<api::Nothing> act_on(const Call& call, Result<ModuleChoice> module,
                          tmcl::Script<tmcl::Result<void>> script, bool news) {
  const auto chosen = co_await must(std::move(module));
  auto done = co_await run_on(chosen, call, std::move(script));
  if (news) expect_news(chosen);
  co_await must(std::move(done));
  co_return api::Nothing{};
}

}  // namespace tmcld

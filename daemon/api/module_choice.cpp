#include "api/module_choice.hpp"

namespace tmcld {

Lookup<ModuleChoice> module_of(const Call& call) {
  return bus_of(call).map([&](std::shared_ptr<GatewayBus> bus) {
    const auto address = static_cast<std::uint16_t>(call.params.integer("address"));
    return ModuleChoice{std::move(bus), tmcl::ModuleAddress{address}};
  });
}

void expect_news(const ModuleChoice& module) {
  auto* known = module.bus->find_module(module.address);
  if (known != nullptr) known->forget_state();
}

}  // namespace tmcld

#include "api/module_choice.hpp"

namespace tmcld {

Lookup<ModuleChoice> module_of(const Call& call) {
  return bus_of(call).map([&](std::shared_ptr<GatewayBus> bus) {
    const auto address = static_cast<std::uint16_t>(call.params.integer("address"));
    return ModuleChoice{std::move(bus), tmcl::ModuleAddress{address}};
  });
}

}  // namespace tmcld

#include "gateway/axis/axis_context.hpp"

#include "gateway/authority/axis_limits.hpp"

namespace tmcld {

AxisContext::AxisContext(AxisConfig config, std::shared_ptr<GatewayBus> bus)
    : config_(std::move(config)),
      bus_(std::move(bus)),
      module_(bus_->add_module(config_.address.module)) {
  bus_->motors().add(config_.address, config_.name, config_.needs_reference);
  if (!config_.motion_limits.of_settings()) return;
  limits_ = std::make_shared<AxisLimits>(config_, module_);
  bus_->gate().add_limits(limits_);
}

std::span<const tmcl::ParameterInfo> AxisContext::parameters() const {
  const auto* model = module_.model();
  return model == nullptr ? std::span<const tmcl::ParameterInfo>{} : tmcl::axis_parameters(*model);
}

AxisContext::Awaitable<void> AxisContext::be_ready() {
  auto ready = co_await module_.be_ready();
  if (!ready) co_return ready;
  const auto* model = module_.model();
  const auto motor = config_.address.motor;
  if (model == nullptr || motor < model->axes) co_return ready;
  co_return tl::unexpected(on_bus(
      tmcl::bad_argument("axis '" + name() + "' is motor " + std::to_string(motor) + ", but a " +
                             std::string(model->name) + " has " + std::to_string(model->axes),
                         module_.is_configured() ? "motors count from 0; correct the configuration"
                                                 : "motors count from 0")));
}

}  // namespace tmcld

/// Axes, modules, buses and events as clients see them.
#pragma once

#include "gateway/axis/poller.hpp"
#include "gateway/bus.hpp"
#include "gateway/event.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/api/system.hpp"

namespace tmcld {

namespace api = tmcl::api;

api::axis::State view_of(const GatewayAxis& axis, const AxisReading& reading);
/// With these of the parameters that were sampled.
void fill(api::PublishedState& into, const GatewayAxis& axis, const PublishedReading& reading,
          const std::vector<std::uint8_t>& parameters);

/// What an axis counts in, with nothing for what is not known.
api::axis::Units view_of(const GatewayAxis& axis, const std::optional<tmcl::ModuleUnits>& module,
                         const std::optional<tmcl::UserScale>& scale);

api::bus::Bus view_of(const GatewayBus& bus);
/// `link`: as tmcl::hint_for() has it.
api::bus::Heard view_of(const tmcl::HeardVerdict& heard, std::string_view link);
/// What its line brought; nothing on CAN.
std::optional<api::bus::Heard> heard_on(const GatewayBus& bus);
api::module::Module view_of(const GatewayBus& bus, const GatewayModule& module);
api::bus::FoundModule view_of(const GatewayBus& bus, const tmcl::FoundModule& module);
api::axis::Axis view_of(const GatewayAxis& axis);
api::Event view_of(const GatewayEvent& event);
api::parameter::Parameter view_of(const tmcl::ParameterInfo& row, const std::string& axis_unit);

std::vector<std::string> texts(const std::vector<std::string_view>& names);
/// Nothing for an empty text, and for none.
std::optional<std::string> if_any(std::string_view text);
/// What a model is called; nothing if it is not known.
std::optional<std::string> name_if_known(const tmcl::Model* model);
std::vector<std::uint8_t> motors_in(std::uint32_t mask);
std::uint32_t mask_of(const std::vector<std::uint8_t>& motors);

}  // namespace tmcld

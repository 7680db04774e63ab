/// States, modules, buses and events as JSON: the same fields wherever they appear.
#pragma once

#include <boost/json/object.hpp>

#include "gateway/bus.hpp"
#include "gateway/event.hpp"
#include "gateway/poller.hpp"

namespace tmcld {

/// "axis", the state's fields and "age_ms".
void add_state(boost::json::object& json, const GatewayAxis& axis, const AxisReading& reading);
/// Also "seq" and "event_time_ms".
void add_state(boost::json::object& json, const GatewayAxis& axis, const PublishedReading& reading);

/// What an axis counts in, with null for what is not known.
boost::json::object units_json(const GatewayAxis& axis,
                               const std::optional<tmcl::ModuleUnits>& module,
                               const std::optional<tmcl::UserScale>& scale);

boost::json::object to_json(const GatewayBus& bus);
boost::json::object to_json(const GatewayBus& bus, const GatewayModule& module);
boost::json::object to_json(const GatewayBus& bus, const tmcl::FoundModule& module);
boost::json::object to_json(const GatewayAxis& axis);
boost::json::object to_json(const GatewayEvent& event);
boost::json::object to_json(const tmcl::ParameterInfo& row, const std::string& axis_unit);

}  // namespace tmcld

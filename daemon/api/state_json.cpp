#include "api/state_json.hpp"

#include "api/can_identifiers.hpp"

#include <string>

#include <boost/json/value.hpp>

#include "tmcl/quantity.hpp"

namespace tmcld {
namespace {

namespace json = boost::json;

std::int64_t milliseconds(tmcl::Duration duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

json::object counters_json(const tmcl::BusCounters& counters) {
  json::object out;
  out["requests"] = counters.requests;
  out["replies"] = counters.replies;
  out["timeouts"] = counters.timeouts;
  out["late_replies"] = counters.late_replies;
  out["unexpected_replies"] = counters.unexpected_replies;
  out["garbage_bytes"] = counters.garbage_bytes;
  out["fences"] = counters.fences;
  out["surplus"] = counters.surplus;
  out["suspect"] = counters.suspect;
  return out;
}

void add_identity(json::object& out, const std::optional<tmcl::FoundModule>& found) {
  for (const auto* key : {"model", "model_number", "firmware", "axes"}) out[key] = nullptr;
  if (!found) return;
  if (!found->model.empty()) out["model"] = found->model;
  out["model_number"] = found->version.model;
  out["firmware"] = to_string(found->version);
  out["axes"] = found->axes;
}

void add_user(json::object& out, const GatewayAxis& axis, const std::optional<UserReading>& user) {
  for (const auto* key : {"unit", "position", "velocity", "target"}) out[key] = nullptr;
  if (!user) return;
  out["unit"] = axis.unit();
  out["position"] = user->position.value;
  if (user->velocity) out["velocity"] = user->velocity->value;
  out["target"] = user->target.value;
}

void add_mechanics(json::object& out, const GatewayAxis& axis) {
  if (const auto& limits = axis.soft_limits()) {
    out["soft_limit_minimum"] = limits->least.value;
    out["soft_limit_maximum"] = limits->greatest.value;
  }
  if (const auto& counts = axis.encoder_counts_per_unit()) out["encoder_counts_per_unit"] = *counts;
}

void add_limits(json::object& out, const GatewayAxis& axis,
                const std::optional<tmcl::UserScale>& scale) {
  const auto& limits = axis.soft_limits();
  if (!limits || (!scale && !axis.unit().empty())) return;
  const auto range =
      microsteps_within(*limits, axis.unit().empty() ? tmcl::microsteps_scale() : *scale);
  out["soft_limit_minimum_microsteps"] = range.least;
  out["soft_limit_maximum_microsteps"] = range.greatest;
}

// A motor that the model does not have is a fault of the configuration, not of the module.
std::string_view state_of(const GatewayAxis& axis) {
  const auto* model = axis.module().model();
  const bool absent = model != nullptr && axis.address().motor >= model->axes;
  return absent ? "no_such_motor" : name_of(axis.module().state());
}

}  // namespace

void add_state(json::object& out, const GatewayAxis& axis, const AxisReading& reading) {
  const auto& state = reading.state;
  out["axis"] = axis.name();
  out["position_microsteps"] = state.position.value;
  out["velocity_internal"] = state.velocity.value;
  out["velocity_pps"] = nullptr;
  if (reading.velocity_pps) out["velocity_pps"] = *reading.velocity_pps;
  out["target_microsteps"] = state.target.value;
  out["position_reached"] = state.position_reached;
  out["moving"] = state.velocity.value != 0;
  add_user(out, axis, reading.user);
  out["age_ms"] = milliseconds(axis.bus().clock().now() - reading.taken);
}

void add_state(json::object& out, const GatewayAxis& axis, const PublishedReading& reading) {
  add_state(out, axis, reading.reading);
  out["seq"] = reading.seq;
  out["event_time_ms"] = milliseconds(reading.reading.taken.time_since_epoch());
}

json::object units_json(const GatewayAxis& axis, const std::optional<tmcl::ModuleUnits>& module,
                        const std::optional<tmcl::UserScale>& scale) {
  json::object out;
  out["axis"] = axis.name();
  for (const auto* key : {"model", "unit", "units_per_revolution", "units_per_output_revolution",
                          "gear_ratio", "reverse", "microsteps_per_revolution", "full_steps",
                          "velocity_unit_pps", "acceleration_unit_pps2", "soft_limit_minimum",
                          "soft_limit_maximum", "soft_limit_minimum_microsteps",
                          "soft_limit_maximum_microsteps", "encoder_counts_per_unit"}) {
    out[key] = nullptr;
  }
  if (const auto* model = axis.module().model()) out["model"] = model->name;
  if (scale) {
    out["reverse"] = scale->reverse;
    out["full_steps"] = scale->steps.full_steps;
    out["microsteps_per_revolution"] = scale->steps.per_revolution();
  }
  if (scale && !scale->unit.empty()) {
    out["unit"] = scale->unit;
    out["units_per_revolution"] = scale->units_per_motor_revolution();
    out["units_per_output_revolution"] = scale->units_per_revolution;
    out["gear_ratio"] = scale->gear_ratio;
    add_mechanics(out, axis);
  }
  add_limits(out, axis, scale);
  if (module) {
    out["velocity_unit_pps"] = module->velocity.value;
    out["acceleration_unit_pps2"] = module->acceleration.value;
  }
  return out;
}

json::object to_json(const GatewayBus& bus) {
  json::object out;
  out["name"] = bus.name();
  out["link"] = to_string(bus.config().link);
  out["state"] = name_of(bus.state());
  out["error"] = nullptr;
  if (!bus.error().empty()) out["error"] = bus.error();
  out["counters"] = counters_json(bus.counters());
  return out;
}

json::object to_json(const GatewayBus& bus, const GatewayModule& module) {
  json::object out;
  out["bus"] = bus.name();
  out["address"] = number(module.address());
  add_identity(out, module.identity());
  out["state"] = name_of(module.state());
  out["duplicate_suspected"] = module.duplicate_suspected();
  return out;
}

json::object to_json(const GatewayBus& bus, const tmcl::FoundModule& module) {
  json::object out;
  out["bus"] = bus.name();
  out["address"] = number(module.address);
  add_identity(out, module);
  out["in_bootloader"] = module.version.bootloader;
  out["duplicate_suspected"] = module.duplicate_suspected;
  out["address_is_reply_id"] = has_address_of_replies(bus, module.address);
  return out;
}

json::object to_json(const GatewayAxis& axis) {
  json::object out;
  out["name"] = axis.name();
  out["bus"] = axis.bus().name();
  out["address"] = number(axis.address().module);
  out["motor"] = axis.address().motor;
  out["model"] = nullptr;
  if (const auto* model = axis.module().model()) out["model"] = model->name;
  out["state"] = state_of(axis);
  out["unit"] = nullptr;
  if (!axis.unit().empty()) out["unit"] = axis.unit();
  return out;
}

json::object to_json(const GatewayEvent& event) {
  json::object out;
  out["kind"] = name_of(event.kind);
  out["bus"] = event.bus;
  out["address"] = nullptr;
  if (event.address) out["address"] = *event.address;
  if (event.kind == GatewayEvent::Kind::target_reached ||
      event.kind == GatewayEvent::Kind::axis_stopped ||
      event.kind == GatewayEvent::Kind::line_broken ||
      event.kind == GatewayEvent::Kind::path_broken ||
      event.kind == GatewayEvent::Kind::mint_broken) {
    json::array motors;
    for (std::uint32_t motor = 0; motor < 32; ++motor) {
      if ((static_cast<std::uint32_t>(event.value) >> motor & 1U) != 0) motors.push_back(motor);
    }
    out["motors"] = std::move(motors);
  }
  if (event.kind == GatewayEvent::Kind::axis_stopped) out["cause"] = "daemon";
  out["text"] = event.text;
  return out;
}

json::object to_json(const tmcl::ParameterInfo& row, const std::string& axis_unit) {
  json::object out;
  out["number"] = row.number;
  out["name"] = row.name;
  out["access"] = row.access == tmcl::Access::read ? "read" : "read_write";
  out["stored"] = row.stored;
  out["minimum"] = row.minimum;
  out["maximum"] = row.maximum;
  out["initial"] = row.initial;
  out["unit"] = row.unit;
  out["meaning"] = row.meaning;
  out["axis_unit"] = nullptr;
  const auto unit = axis_unit.empty() ? std::string() : unit_of(row, axis_unit);
  if (!unit.empty()) out["axis_unit"] = unit;
  json::array aliases;
  for (const auto alias : row.aliases) {
    if (!alias.empty()) aliases.emplace_back(alias);
  }
  out["aliases"] = std::move(aliases);
  return out;
}

}  // namespace tmcld

#include "api/views.hpp"

#include <string>

#include "api/can_identifiers.hpp"
#include "tmcl/bit_rate.hpp"
#include "tmcl/quantity.hpp"

namespace tmcld {
namespace {

std::int64_t milliseconds(tmcl::Duration duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

template <class Module>
Module with_identity(const GatewayBus& bus, tmcl::ModuleAddress address,
                     const std::optional<tmcl::FoundModule>& found) {
  Module out;
  out.bus = bus.name();
  out.address = number(address);
  if (!found) return out;
  out.model = if_any(found->model);
  out.model_number = found->version.model;
  out.firmware = to_string(found->version);
  out.axes = found->axes;
  return out;
}

void fill_limits(api::axis::Units& out, const GatewayAxis& axis,
                 const std::optional<tmcl::UserScale>& scale) {
  const auto& limits = axis.soft_limits();
  if (!limits || (!scale && !axis.unit().empty())) return;
  const auto range =
      microsteps_within(*limits, axis.unit().empty() ? tmcl::microsteps_scale() : *scale);
  out.soft_limit_minimum_microsteps = range.least;
  out.soft_limit_maximum_microsteps = range.greatest;
}

// A motor that the model does not have is a fault of the configuration, not of the module.
std::string_view state_of(const GatewayAxis& axis) {
  const auto* model = axis.module().model();
  const bool absent = model != nullptr && axis.address().motor >= model->axes;
  return absent ? "no_such_motor" : name_of(axis.module().state());
}

std::vector<api::axis::RampSetting> view_of(const std::vector<UnrestoredSetting>& settings) {
  std::vector<api::axis::RampSetting> view;
  for (const auto& [parameter, number, before] : settings)
    view.push_back({parameter, number, before});
  return view;
}

api::Sample view_of(const GatewayAxis& axis, const ParameterSample& sample) {
  api::Sample out;
  const auto* row = find_parameter(axis.parameters(), sample.parameter);
  if (row != nullptr) out.parameter = std::string(row->name);
  out.number = sample.parameter;
  out.value = sample.value;
  if (sample.in_unit) {
    out.unit = sample.in_unit->unit;
    out.value_in_unit = sample.in_unit->number;
  }
  out.age_ms = milliseconds(axis.bus().clock().now() - sample.taken);
  return out;
}

void fill(api::axis::State& out, const GatewayAxis& axis, const AxisReading& reading,
          const AxisStanding& standing) {
  const auto& state = reading.state;
  out.axis = axis.name();
  out.position_microsteps = state.position.value;
  out.velocity_internal = state.velocity.value;
  out.velocity_pps = reading.velocity_pps;
  out.target_microsteps = state.target.value;
  out.position_reached = state.position_reached;
  out.moving = state.velocity.value != 0 || reading.is_bound;
  if (const auto& user = reading.user) {
    out.unit = axis.unit();
    out.position = user->position.value;
    if (user->velocity) out.velocity = user->velocity->value;
    out.target = user->target.value;
  }
  out.age_ms = milliseconds(axis.bus().clock().now() - reading.taken);
  out.latched = standing.is_latched;
  out.referenced = standing.is_referenced;
  if (standing.stop_cause) out.stop_cause = std::string(name_of(*standing.stop_cause));
  out.last_stop = standing.last_stop;
  if (standing.lease != 0) out.lease = standing.lease;
  out.unattended = standing.is_unattended;
  out.owner = if_any(standing.owner);
  out.unrestored = view_of(standing.unrestored);
  out.faults = texts(standing.faults);
}

/// What the module is set to says nothing about what it does.
api::WordOr<api::axis::Deadman> view_of(const Deadman& deadman) {
  const auto tested = deadman.stops_after_ms();
  if (deadman.set_ms() == 0 || tested == 0) return {"none"};
  if (!deadman.set_ms() || !tested) return {"unknown"};
  return {api::axis::Deadman{*deadman.set_ms(), *tested}};
}

const char* settings_state_of(const GatewayModule& module) {
  if (!module.settings_config().wanted) return "none";
  const auto& drift = module.drift();
  return !drift ? "unknown" : drift->empty() ? "as_file" : "differ";
}

}  // namespace

std::vector<std::string> texts(const std::vector<std::string_view>& names) {
  return {names.begin(), names.end()};
}

std::optional<std::string> if_any(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional<std::string>(text);
}

std::optional<std::string> name_if_known(const tmcl::Model* model) {
  return if_any(model == nullptr ? std::string_view{} : model->name);
}

std::vector<std::uint8_t> motors_in(std::uint32_t mask) {
  std::vector<std::uint8_t> motors;
  for (std::uint8_t motor = 0; motor < 32; ++motor) {
    if ((mask >> motor & 1U) != 0) motors.push_back(motor);
  }
  return motors;
}

std::uint32_t mask_of(const std::vector<std::uint8_t>& motors) {
  std::uint32_t mask = 0;
  for (const auto motor : motors) mask |= 1U << motor;
  return mask;
}

api::axis::State view_of(const GatewayAxis& axis, const AxisReading& reading) {
  api::axis::State out;
  fill(out, axis, reading, AxisStanding(axis));
  return out;
}

void fill(api::PublishedState& into, const GatewayAxis& axis, const PublishedReading& reading,
          const std::vector<std::uint8_t>& parameters) {
  fill(into, axis, reading.reading, reading.standing);
  for (const auto number : parameters) {
    const auto read = std::ranges::find(reading.samples, number, &ParameterSample::parameter);
    if (read != reading.samples.end()) into.samples.push_back(view_of(axis, *read));
  }
  into.seq = reading.seq;
  into.event_time_ms = milliseconds(reading.reading.taken.time_since_epoch());
}

api::axis::Units view_of(const GatewayAxis& axis, const std::optional<tmcl::ModuleUnits>& module,
                         const std::optional<tmcl::UserScale>& scale) {
  api::axis::Units out{axis.name(), name_if_known(axis.module().model())};
  if (scale) {
    out.reverse = scale->reverse;
    out.full_steps = scale->steps.full_steps;
    out.microsteps_per_revolution = scale->steps.per_revolution();
  }
  if (scale && !scale->unit.empty()) {
    out.unit = scale->unit;
    out.units_per_revolution = scale->units_per_motor_revolution();
    out.units_per_output_revolution = scale->units_per_revolution;
    out.gear_ratio = scale->gear_ratio;
    out.encoder_counts_per_unit = axis.encoder_counts_per_unit();
    if (const auto& limits = axis.soft_limits()) {
      out.soft_limit_minimum = limits->least.value;
      out.soft_limit_maximum = limits->greatest.value;
    }
  }
  fill_limits(out, axis, scale);
  if (module) {
    out.velocity_unit_pps = module->velocity.value;
    out.acceleration_unit_pps2 = module->acceleration.value;
  }
  return out;
}

api::bus::Bus view_of(const GatewayBus& bus) {
  const auto counters = bus.link().counters();
  return {bus.name(),
          to_string(bus.config().link),
          std::string(name_of(bus.state())),
          if_any(bus.error()),
          tmcl::bit_rate_of(bus.config().link),
          {counters.requests, counters.replies, counters.timeouts, counters.late_replies,
           counters.unexpected_replies, counters.garbage_bytes, counters.fences, counters.surplus,
           counters.suspect},
          heard_on(bus)};
}

api::bus::Heard view_of(const tmcl::HeardVerdict& heard, std::string_view link) {
  return {std::string(name_of(heard.kind)), heard.bytes, if_any(heard.text), meaning_of(heard),
          if_any(tmcl::hint_for(heard.kind, link))};
}

std::optional<api::bus::Heard> heard_on(const GatewayBus& bus) {
  if (bus.is_can()) return std::nullopt;
  const auto* port = std::get_if<tmcl::SerialName>(&bus.config().link);
  return view_of(bus.link().heard().verdict(), port != nullptr ? "serial:" + port->device : "");
}

api::module::Module view_of(const GatewayBus& bus, const GatewayModule& module) {
  auto out = with_identity<api::module::Module>(bus, module.address(), module.identity());
  out.state = name_of(module.state());
  out.duplicate_suspected = module.duplicate_suspected();
  out.watched_by = module.sentinel().name();
  out.deadman = view_of(module.deadman());
  out.settings = settings_state_of(module);
  return out;
}

api::bus::FoundModule view_of(const GatewayBus& bus, const tmcl::FoundModule& module) {
  auto out = with_identity<api::bus::FoundModule>(bus, module.address, module);
  out.in_bootloader = module.version.bootloader;
  out.duplicate_suspected = module.duplicate_suspected;
  out.address_is_reply_id = has_address_of_replies(bus, module.address);
  return out;
}

api::axis::Axis view_of(const GatewayAxis& axis) {
  return {axis.name(),
          axis.bus().name(),
          number(axis.address().module),
          axis.address().motor,
          name_if_known(axis.module().model()),
          std::string(state_of(axis)),
          if_any(axis.unit()),
          texts(axis.faults())};
}

api::Event view_of(const GatewayEvent& event) {
  api::Event out{
      std::string(name_of(event.kind)), event.bus, event.address, {}, {}, {}, {}, event.text};
  if (event.kind == GatewayEvent::Kind::target_reached ||
      event.kind == GatewayEvent::Kind::axis_stopped ||
      event.kind == GatewayEvent::Kind::axis_fault ||
      event.kind == GatewayEvent::Kind::lease_lost ||
      event.kind == GatewayEvent::Kind::owner_lost ||
      event.kind == GatewayEvent::Kind::line_broken ||
      event.kind == GatewayEvent::Kind::path_broken ||
      event.kind == GatewayEvent::Kind::mint_broken ||
      event.kind == GatewayEvent::Kind::jog_broken ||
      event.kind == GatewayEvent::Kind::approach_broken)
    out.motors = motors_in(static_cast<std::uint32_t>(event.value));
  out.cause = if_any(event.cause);
  out.reason = if_any(event.reason);
  if (!event.unrestored.empty()) out.unrestored = view_of(event.unrestored);
  return out;
}

api::parameter::Parameter view_of(const tmcl::ParameterInfo& row, const std::string& axis_unit) {
  api::parameter::Parameter out{row.number,
                                std::string(row.name),
                                row.access == tmcl::Access::read ? "read" : "read_write",
                                row.stored,
                                row.minimum,
                                row.maximum,
                                row.initial,
                                std::string(row.unit),
                                std::string(row.meaning),
                                {},
                                {}};
  if (!axis_unit.empty()) out.axis_unit = if_any(unit_of(row, axis_unit));
  for (const auto alias : row.aliases) {
    if (!alias.empty()) out.aliases.emplace_back(alias);
  }
  return out;
}

}  // namespace tmcld

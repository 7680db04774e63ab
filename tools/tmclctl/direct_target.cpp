#include "direct_target.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tmcl/prediction.hpp"

namespace tmclctl {
namespace {

using tmcl::blocking::Axis;

// Modules are numbered from 1 upwards, so the first of them are told to stop before the rest has
// been looked for.
constexpr std::uint16_t stop_scan_step = 16;
constexpr std::uint16_t stop_scan_last = 255;
// How often who waits for arrivals gets to look at the clock and at signals.
constexpr auto listening_time = std::chrono::milliseconds(100);

tmcl::Script<tmcl::Result<void>> listen_a_while() {
  co_await tmcl::pause(listening_time);
  co_return tmcl::Result<void>{};
}

ModuleRow row_of(const tmcl::FoundModule& found, const std::string& bus, tmcl::Framing framing) {
  ModuleRow row{bus,
                number(found.address),
                std::string(found.model),
                found.version.model,
                {},
                found.axes,
                found.duplicate_suspected,
                {},
                found.version.bootloader};
  row.firmware = to_string(found.version);
  row.address_is_reply_id =
      framing == tmcl::Framing::can && row.address == tmcl::LinkOptions{}.can_reply_id;
  return row;
}

ParameterRow row_of(const tmcl::ParameterInfo& info) {
  std::vector<std::string> aliases;
  for (const auto alias : info.aliases) {
    if (!alias.empty()) aliases.emplace_back(alias);
  }
  return {info.number,
          std::string(info.name),
          info.access == tmcl::Access::read_write,
          info.minimum,
          info.maximum,
          std::string(info.unit),
          std::string(info.meaning),
          info.stored,
          info.initial,
          std::move(aliases)};
}

/// As tmcld does it: a module may take what it cannot do.
Attempt<void> in_range(const tmcl::ParameterInfo* row, std::int32_t value) {
  if (row == nullptr) return {};
  if (row->access == tmcl::Access::read)
    return tl::unexpected(
        usage_failure("read_only", fmt::format("'{}' can only be read", row->name)));
  // Where the range depends on the unit mode, the module is left to judge.
  const bool within = value >= row->minimum && value <= row->maximum;
  if (within || row->scale != tmcl::Scale::fixed) return {};
  return tl::unexpected(
      usage_failure("out_of_range", fmt::format("{} is outside {}..{}, the range of {}", value,
                                                row->minimum, row->maximum, row->name)));
}

/// Lets a pty appear that a simulator is about to make, or an adapter that was just plugged in; a
/// signal ends that. Returns how long it took.
tmcl::Duration await_port(const tmcl::LinkName& name, tmcl::Duration wait, Patience& patience) {
  const auto* port = std::get_if<tmcl::SerialName>(&name);
  if (port == nullptr) return {};
  const auto began = patience.now();
  while (patience.now() - began < wait && patience.signal() == 0 &&
         tmcl::is_missing(port->device) && tmcl::may_appear(port->device)) {
    patience.sleep(tmcl::file_look_interval);
  }
  return patience.now() - began;
}

}  // namespace

Attempt<std::unique_ptr<Target>> DirectTarget::open(const std::string& link_name,
                                                    std::int32_t full_steps, tmcl::Duration wait,
                                                    Patience& patience) {
  const auto name = attempt(tmcl::parse_link_name(link_name));
  if (!name) return tl::unexpected(name.error());
  const auto waited = await_port(*name, wait, patience);
  auto link = attempt(tmcl::Link::open(*name));
  if (!link) {
    link.error().message += tmcl::waited_text(waited);
    return tl::unexpected(link.error());
  }
  const auto framing = link->framing();
  return std::make_unique<DirectTarget>(tmcl::blocking::Bus(std::move(*link)), framing, full_steps,
                                        patience);
}

DirectTarget::DirectTarget(tmcl::blocking::Bus bus, tmcl::Framing framing, std::int32_t full_steps,
                           Patience& patience)
    : bus_(std::move(bus)), framing_(framing), full_steps_(full_steps), patience_(patience) {}

Attempt<Axis> DirectTarget::axis_at(const std::string& name) {
  return parse_axis_address(name).map(
      [&](tmcl::AxisAddress address) { return bus_.module(address.module).axis(address.motor); });
}

Attempt<ScanResult> DirectTarget::scan(ScanRange range, const Progress& progress) {
  tmcl::ScanOptions options;
  options.first = range.first;
  options.last = range.last;
  if (progress) {
    options.progress = [&](std::size_t asked, std::size_t of) { progress(bus_.name(), asked, of); };
  }
  return attempt(bus_.run(tmcl::verbs::scan(options))).map([&](const auto& found) {
    ScanResult result;
    for (const auto& module : found)
      result.modules.push_back(row_of(module, bus_.name(), framing_));
    return result;
  });
}

Attempt<std::vector<ModuleRow>> DirectTarget::modules() {
  return scan({}, {}).map([](ScanResult found) { return std::move(found.modules); });
}

Attempt<std::vector<AxisRow>> DirectTarget::axes() {
  return modules().map([&](const std::vector<ModuleRow>& found) {
    std::vector<AxisRow> rows;
    for (const auto& module : found) {
      for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
        const auto name = axis_name({tmcl::ModuleAddress{module.address}, motor});
        rows.push_back({name, module.bus, module.address, motor, module.model, "ready"});
      }
    }
    return rows;
  });
}

Attempt<const tmcl::Model*> DirectTarget::model_of(tmcl::ModuleAddress module) {
  const auto known = models_.find(module);
  if (known != models_.end()) return known->second;
  const auto found = attempt(bus_.module(module).identify());
  if (!found) return tl::unexpected(found.error());
  if (found->version.bootloader) return tl::unexpected(failure_from(tmcl::no_firmware(module)));
  return models_[module] = tmcl::find_model(found->version.model);
}

Attempt<std::span<const tmcl::ParameterInfo>> DirectTarget::table_of(tmcl::ModuleAddress module) {
  return model_of(module).map([](const tmcl::Model* model) {
    return model != nullptr ? tmcl::axis_parameters(*model) : common_parameters();
  });
}

Attempt<ParameterName> DirectTarget::parameter_of(tmcl::ModuleAddress module,
                                                  const std::string& text) {
  return table_of(module).and_then([&](auto table) { return parse_parameter(table, text); });
}

Attempt<void> DirectTarget::check(tmcl::ModuleAddress module, std::uint8_t parameter,
                                  std::int32_t value) {
  return model_of(module).and_then([&](const tmcl::Model* model) -> Attempt<void> {
    if (model == nullptr) return {};
    return in_range(find_parameter(tmcl::axis_parameters(*model), parameter), value);
  });
}

Attempt<std::vector<ParameterRow>> DirectTarget::parameters(const std::string& axis) {
  const auto address = parse_axis_address(axis);
  if (!address) return tl::unexpected(address.error());
  return table_of(address->module).map([](auto table) {
    std::vector<ParameterRow> rows;
    for (const auto& info : table) rows.push_back(row_of(info));
    return rows;
  });
}

Attempt<ParameterValue> DirectTarget::get(const std::string& axis, const std::string& parameter) {
  auto at = axis_at(axis);
  if (!at) return tl::unexpected(at.error());
  const auto name = parameter_of(at->address().module, parameter);
  if (!name) return tl::unexpected(name.error());
  return attempt(at->get(name->number)).map([&](std::int32_t value) {
    return ParameterValue{name->number, name->name, value};
  });
}

Attempt<ParameterValue> DirectTarget::set(const std::string& axis, const std::string& parameter,
                                          const Typed& typed) {
  auto at = axis_at(axis);
  if (!at) return tl::unexpected(at.error());
  const auto name = parameter_of(at->address().module, parameter);
  if (!name) return tl::unexpected(name.error());
  const auto value = in_module(typed.text, axis, name->number);
  if (!value) return tl::unexpected(value.error());
  const auto allowed = check(at->address().module, name->number, *value);
  if (!allowed) return tl::unexpected(allowed.error());
  return attempt(at->set(name->number, *value)).map([&] {
    return ParameterValue{name->number, name->name, *value};
  });
}

namespace {

Attempt<std::optional<tmcl::ModuleUnits>> read_module_units(Axis& at, const AxisUnits& units) {
  std::vector<std::int32_t> values;
  for (const auto number : tmcl::unit_parameters(*units.model)) {
    const auto value = attempt(at.get(number));
    if (!value) return tl::unexpected(value.error());
    values.push_back(*value);
  }
  return tmcl::module_units(*units.model, values);
}

}  // namespace

Attempt<AxisUnits> DirectTarget::units(const std::string& axis) {
  auto at = axis_at(axis);
  if (!at) return tl::unexpected(at.error());
  const auto model = model_of(at->address().module);
  if (!model) return tl::unexpected(model.error());
  AxisUnits units{axis, *model};
  if (units.model == nullptr) return units;
  const auto module = read_module_units(*at, units);
  if (!module) return tl::unexpected(module.error());
  units.module = *module;
  if (find_parameter(units.parameters(), tmcl::axis_parameter::microstep_resolution) == nullptr)
    return units;
  const auto resolution = attempt(at->get(tmcl::axis_parameter::microstep_resolution));
  if (!resolution) return tl::unexpected(resolution.error());
  if (*resolution >= 0 && *resolution <= tmcl::max_microstep_resolution)
    units.scale = tmcl::UserScale{"", 1, false, {full_steps_, *resolution}};
  return units;
}

Attempt<std::int32_t> DirectTarget::in_module(const std::string& text, const std::string& axis,
                                              std::uint8_t parameter) {
  const auto quantity = attempt(tmcl::parse_quantity(text));
  if (!quantity) return tl::unexpected(quantity.error());
  if (quantity->unit.empty()) {
    return attempt(to_microsteps(*quantity, AxisUnits{axis})).map([](tmcl::Microsteps bare) {
      return bare.value;
    });
  }
  const auto units = this->units(axis);
  if (!units) return tl::unexpected(units.error());
  const auto* row = find_parameter(units->parameters(), parameter);
  if (row != nullptr) return attempt(to_parameter(*quantity, *units, *row));
  return tl::unexpected(usage_failure(
      "unknown_unit", fmt::format("'{}': what parameter {} of axis {} counts in is not known", text,
                                  parameter, axis)));
}

// Whatever comes of the readings: they only serve to tell more about a move.
std::optional<tmcl::plan::AxisTwin> DirectTarget::twin_of(Axis& at) {
  const auto model = model_of(at.address().module);
  if (!model || *model == nullptr) return std::nullopt;
  auto ramp = bus_.run(tmcl::verbs::read_ramp(at.address(), **model));
  if (!ramp) return std::nullopt;
  const auto twin = bus_.run(tmcl::verbs::read_twin(at.address(), **model, std::move(*ramp)));
  return twin ? std::optional(*twin) : std::nullopt;
}

template <class Move>
Attempt<StartedMove> DirectTarget::start(const std::string& axis, Move move) {
  auto at = axis_at(axis);
  if (!at) return tl::unexpected(at.error());
  auto twin = twin_of(*at);
  return attempt(move(*at)).map([&](tmcl::Microsteps goal) {
    StartedMove started{goal, {}};
    if (twin) twin->move_to(goal);
    const auto arrival = twin ? twin->time_to_arrival() : std::nullopt;
    if (arrival) started.predicted_s = std::chrono::duration<double>(*arrival).count();
    return started;
  });
}

Attempt<StartedMove> DirectTarget::move_to(const std::string& axis, const Typed& position) {
  return in_module(position.text, axis, tmcl::axis_parameter::target_position)
      .and_then([&](std::int32_t place) {
        return start(axis, [&](Axis& at) { return at.move_to({place}); });
      });
}

Attempt<StartedMove> DirectTarget::move_by(const std::string& axis, const Typed& distance) {
  return in_module(distance.text, axis, tmcl::axis_parameter::target_position)
      .and_then([&](std::int32_t way) {
        return start(axis, [&](Axis& at) { return at.move_by({way}); });
      });
}

Attempt<Turning> DirectTarget::rotate(const std::string& axis, const Typed& typed) {
  const auto value = in_module(typed.text, axis, tmcl::axis_parameter::target_velocity);
  if (!value) return tl::unexpected(value.error());
  const tmcl::InternalVelocity velocity{*value};
  return axis_at(axis).and_then([&](Axis at) { return attempt(at.rotate(velocity)); }).map([&] {
    return Turning{velocity, {}};
  });
}

Attempt<void> DirectTarget::stop(const std::string& axis) {
  return axis_at(axis).and_then([](Axis at) { return attempt(at.stop()); });
}

void DirectTarget::stop_motors(const tmcl::FoundModule& module, std::vector<StoppedAxis>& stopped) {
  for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
    const auto before = patience_.now();
    const auto result = attempt(bus_.module(module.address).axis(motor).stop());
    const std::chrono::duration<double, std::milli> took = patience_.now() - before;
    StoppedAxis row{axis_name({module.address, motor}), {}, {}};
    if (result) {
      row.milliseconds = took.count();
    } else {
      row.failure = result.error();
    }
    stopped.push_back(std::move(row));
  }
}

Attempt<std::vector<StoppedAxis>> DirectTarget::stop_all() {
  std::vector<StoppedAxis> stopped;
  for (std::uint16_t first = 1; first <= stop_scan_last; first += stop_scan_step) {
    tmcl::ScanOptions options;
    options.first = first;
    options.last = std::min<std::uint16_t>(static_cast<std::uint16_t>(first + stop_scan_step - 1),
                                           stop_scan_last);
    const auto found = attempt(bus_.run(tmcl::verbs::scan(options)));
    if (!found) return tl::unexpected(found.error());
    for (const auto& module : *found) stop_motors(module, stopped);
  }
  return stopped;
}

Attempt<AxisReading> DirectTarget::state(const std::string& axis) {
  auto at = axis_at(axis);
  if (!at) return tl::unexpected(at.error());
  const auto taken_at = patience_.now();
  return attempt(at->state()).map([&](const tmcl::AxisState& state) {
    AxisReading reading;
    reading.position = state.position;
    reading.velocity = state.velocity;
    reading.target = state.target;
    reading.position_reached = state.position_reached;
    reading.moving = state.velocity.value != 0;
    reading.taken_at = taken_at;
    reading.age = patience_.now() - taken_at;
    return reading;
  });
}

Attempt<void> DirectTarget::watch(const std::string& axis, tmcl::Duration interval,
                                  const ReadingHandler& on_reading) {
  while (true) {
    const auto due = patience_.now() + interval;
    const auto reading = state(axis);
    if (!reading) return tl::unexpected(reading.error());
    if (!on_reading(&*reading)) return {};
    patience_.sleep(due - patience_.now());
  }
}

Attempt<RawAnswer> DirectTarget::raw(const RawCommand& command) {
  return attempt(bus_.execute(command.request)).map([&](const tmcl::Answer& answer) {
    RawAnswer raw{bus_.name(), framing_, answer.reply, {}};
    if (answer.version_text) {
      const auto text = to_text(*answer.version_text);
      raw.text.assign(text.begin(), text.end());
    }
    return raw;
  });
}

Attempt<tmcl::ModuleAddress> DirectTarget::address_of(const ModuleName& module) {
  if (module.bus.empty()) return tmcl::ModuleAddress{module.address};
  return tl::unexpected(usage_failure("usage", "with --direct there is one bus, without a name",
                                      "Name the module by its address only"));
}

Attempt<tmcl::FirmwareMatch> DirectTarget::match_firmware(const ModuleName& module,
                                                          const tmcl::firmware::Image& image) {
  return address_of(module).and_then([&](tmcl::ModuleAddress address) {
    return attempt(bus_.run(tmcl::verbs::match_firmware(address, image)));
  });
}

Attempt<tmcl::FirmwareReport> DirectTarget::upload_firmware(const ModuleName& module,
                                                            const tmcl::firmware::Image& image,
                                                            const tmcl::FirmwareOptions& options) {
  return address_of(module).and_then([&](tmcl::ModuleAddress address) {
    return attempt(bus_.run(tmcl::verbs::upload_firmware(address, image, options)));
  });
}

Attempt<void> DirectTarget::hear_arrivals(const ModuleName& module,
                                          const std::function<Attempt<void>()>& ask,
                                          const ArrivalHandler& on_arrival) {
  const auto address = address_of(module);
  if (!address) return tl::unexpected(address.error());
  bool wanted = true;
  bus_.on_event([&](const tmcl::BusEvent& event) {
    if (event.kind != tmcl::BusEvent::Kind::target_reached || event.module != *address) return;
    std::vector<std::uint8_t> motors;
    for (std::uint8_t motor = 0; motor < 32; ++motor) {
      if ((static_cast<std::uint32_t>(event.value) >> motor & 1U) != 0) motors.push_back(motor);
    }
    if (wanted) wanted = on_arrival(&motors);
  });
  auto result = ask();
  while (result && wanted && bus_.is_open()) {
    wanted = on_arrival(nullptr);
    if (wanted) result = attempt(bus_.run(listen_a_while()));
  }
  // Why the bus is not open any more.
  if (result && wanted) result = attempt(bus_.module(*address).identify()).map([](const auto&) {});
  bus_.on_event({});
  return result;
}

std::string DirectTarget::options() const { return " --direct " + bus_.name(); }

}  // namespace tmclctl

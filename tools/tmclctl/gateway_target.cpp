#include "gateway_target.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "json_read.hpp"
#include "tmcl/hex.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

// A movement that had to wait longer than this for its turn is not what the user expects any more.
constexpr int move_deadline_ms = 5000;
// How often the watching verb gets to look at the clock and at signals when nothing changes.
constexpr auto longest_silence = std::chrono::milliseconds(100);
// An axis that says nothing for so long while it is watched is asked whether it is still there.
constexpr auto doubtful_silence = std::chrono::seconds(1);
// Of a firmware image, in one line of the protocol: a third of what that may have.
constexpr std::size_t staged_at_once = 16'384;
// A module may say nothing for so long while it erases its firmware, three times.
constexpr auto longest_firmware_step = std::chrono::seconds(75);
// Of an axis whose module was not asked yet.
constexpr std::string_view unknown_state = "unknown";
// Modules are numbered from 1 upwards, so the first of them are told to stop before the rest has
// been looked for.
constexpr std::uint16_t stop_scan_step = 16;
constexpr std::uint16_t stop_scan_last = 255;
// Planning a long path takes a while.
constexpr auto longest_path_silence = std::chrono::seconds(120);

// The contract takes a number or a name; a number must not travel as text.
json::value parameter_value(const std::string& text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && end == text.data() + text.size()) return number;
  return json::value(text);
}

ModuleRow module_from(const json::object& row) {
  auto state = text_at(row, "state");
  const bool in_bootloader = state == "in_bootloader" || flag_at(row, "in_bootloader");
  return {text_at(row, "bus"),
          integer_at<std::uint16_t>(row, "address"),
          text_at(row, "model"),
          integer_at<std::uint16_t>(row, "model_number"),
          text_at(row, "firmware"),
          integer_at<std::uint8_t>(row, "axes"),
          flag_at(row, "duplicate_suspected"),
          std::move(state),
          in_bootloader,
          flag_at(row, "address_is_reply_id")};
}

AxisRow axis_from(const json::object& row) {
  return {text_at(row, "name"),
          text_at(row, "bus"),
          integer_at<std::uint16_t>(row, "address"),
          integer_at<std::uint8_t>(row, "motor"),
          text_at(row, "model"),
          text_at(row, "state"),
          text_at(row, "unit")};
}

std::optional<InUnit> in_unit_at(const json::object& row, std::string_view key) {
  const auto value = number_at(row, key);
  if (!value) return std::nullopt;
  return InUnit{*value, text_at(row, "unit")};
}

ParameterRow parameter_from(const json::object& row) {
  const auto access = text_at(row, "access");
  std::vector<std::string> aliases;
  for (const auto& alias : array_at(row, "aliases")) {
    if (const auto* name = alias.if_string()) aliases.emplace_back(*name);
  }
  return {integer_at<std::uint8_t>(row, "number"),
          text_at(row, "name"),
          access.find('w') != std::string::npos,
          integer_at<std::int32_t>(row, "minimum"),
          integer_at<std::int32_t>(row, "maximum"),
          text_at(row, "unit"),
          text_at(row, "meaning"),
          flag_at(row, "stored"),
          integer_at<std::int32_t>(row, "initial"),
          std::move(aliases)};
}

Failure failure_at(const json::object& row) {
  return failure_from(tmcl::client::call_error_from(object_at(row, "error")));
}

ParameterValue value_from(const json::object& row) {
  const auto number = integer_at<std::uint8_t>(row, "number");
  auto name = text_at(row, "parameter");
  if (name.empty()) name = std::to_string(number);
  return {number, std::move(name), integer_at<std::int32_t>(row, "value"),
          in_unit_at(row, "value_in_unit")};
}

std::optional<tmcl::UserScale> scale_from(const json::object& row) {
  const auto microsteps = integer_at<std::int32_t>(row, "microsteps_per_revolution");
  if (microsteps <= 0) return std::nullopt;
  // A tmcld that knows of no gears tells the second one only.
  const auto of_turn = number_at(row, "units_per_output_revolution")
                           .value_or(number_at(row, "units_per_revolution").value_or(1));
  return tmcl::UserScale{text_at(row, "unit"),
                         of_turn,
                         flag_at(row, "reverse"),
                         {microsteps, 0},
                         number_at(row, "gear_ratio").value_or(1)};
}

std::optional<tmcl::SoftLimits> limits_from(const json::object& row) {
  const std::string in = text_at(row, "unit").empty() ? "_microsteps" : "";
  const auto least = number_at(row, "soft_limit_minimum" + in);
  const auto greatest = number_at(row, "soft_limit_maximum" + in);
  if (!least || !greatest) return std::nullopt;
  return tmcl::SoftLimits{{*least}, {*greatest}};
}

std::optional<tmcl::ModuleUnits> module_units_from(const json::object& row) {
  const auto velocity = number_at(row, "velocity_unit_pps");
  const auto acceleration = number_at(row, "acceleration_unit_pps2");
  if (!velocity || !acceleration) return std::nullopt;
  return tmcl::ModuleUnits{{*velocity}, {*acceleration}};
}

tmcl::FirmwareVersion version_at(const json::object& row, std::string_view key) {
  return tmcl::version_from_text(text_at(row, key)).value_or(tmcl::FirmwareVersion{});
}

tmcl::FirmwareMatch match_from(const json::object& row, std::string_view running,
                               const tmcl::firmware::Image& image) {
  tmcl::FirmwareMatch match;
  match.model = integer_at<std::uint16_t>(row, "model_number");
  match.running = version_at(row, running);
  match.in_bootloader = match.running.bootloader;
  match.offered = versions_in(image);
  match.version = version_for(image, match.model);
  return match;
}

UnscannedBus unscanned_from(const json::object& row) {
  return {text_at(row, "bus"), failure_at(row)};
}

Attempt<void> stage(Door& door, std::string_view method, std::span<const std::uint8_t> bytes,
                    const CallOptions& options = {}) {
  for (std::size_t offset = 0; offset < bytes.size(); offset += staged_at_once) {
    const auto part = bytes.subspan(offset, std::min(staged_at_once, bytes.size() - offset));
    const auto taken =
        door.call(method, {{"offset", offset}, {"data", tmcl::to_hex(part)}}, options);
    if (!taken) return tl::unexpected(taken.error());
  }
  return {};
}

}  // namespace

GatewayTarget::GatewayTarget(std::unique_ptr<Door> door, std::string options, AxesFrom axes,
                             Host& host)
    : door_(std::move(door)), options_(std::move(options)), axes_from_(axes), host_(host) {}

Attempt<json::object> GatewayTarget::call(std::string_view method, json::object params) {
  return door_->call(method, std::move(params));
}

Attempt<ScanResult> GatewayTarget::scan(ScanRange range, const Progress& progress) {
  if (progress) {
    door_->on_notification([&](std::string_view method, const json::object& params) {
      if (method != "notify_progress") return;
      progress(text_at(params, "bus"), integer_at<std::size_t>(params, "asked"),
               integer_at<std::size_t>(params, "of"));
    });
  }
  auto result = call("bus.scan", {{"first", range.first}, {"last", range.last}});
  door_->on_notification({});
  return std::move(result).map([](const json::object& found) {
    return ScanResult{rows_at<ModuleRow>(found, "modules", module_from),
                      rows_at<UnscannedBus>(found, "failed", unscanned_from)};
  });
}

Attempt<std::vector<ModuleRow>> GatewayTarget::modules() {
  if (axes_from_ == AxesFrom::scan) {
    auto found = scan({}, {});
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().failure);
    return std::move(found->modules);
  }
  return call("module.list", {}).map([](const json::object& found) {
    return rows_at<ModuleRow>(found, "modules", module_from);
  });
}

Attempt<std::vector<AxisRow>> GatewayTarget::found_axes() {
  return modules().map([](const std::vector<ModuleRow>& found) {
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

Attempt<std::vector<AxisRow>> GatewayTarget::axes() {
  if (axes_from_ == AxesFrom::scan) return found_axes();
  auto rows = call("axis.list", {}).map([](const json::object& found) {
    return rows_at<AxisRow>(found, "axes", axis_from);
  });
  if (rows && std::ranges::count(*rows, unknown_state, &AxisRow::state) != 0) add_reasons(*rows);
  return rows;
}

/// For axes whose bus is not open. They are listed all the same if tmcld cannot say more.
void GatewayTarget::add_reasons(std::vector<AxisRow>& axes) {
  const auto listed = call("bus.list", {});
  if (!listed) return;
  for (const auto& value : array_at(*listed, "buses")) {
    const auto& bus = value.is_object() ? value.get_object() : json::object{};
    if (text_at(bus, "state") == "open") continue;
    const auto error = text_at(bus, "error");
    for (auto& axis : axes) {
      if (axis.bus == text_at(bus, "name") && axis.state == unknown_state)
        axis.why = error.empty() ? "it is being opened" : error;
    }
  }
}

Attempt<std::vector<ParameterRow>> GatewayTarget::parameters(const std::string& axis) {
  return call("parameter.list", {{"axis", axis}}).map([](const json::object& found) {
    return rows_at<ParameterRow>(found, "parameters", parameter_from);
  });
}

Attempt<ParameterValue> GatewayTarget::get(const std::string& axis, const std::string& parameter) {
  return call("parameter.get", {{"axis", axis}, {"parameter", parameter_value(parameter)}})
      .map(value_from);
}

Attempt<ParameterValue> GatewayTarget::set(const std::string& axis, const std::string& parameter,
                                           const Typed& value) {
  json::object params{{"axis", axis}, {"parameter", parameter_value(parameter)}};
  put(params, "value_in_unit", "value", value);
  return call("parameter.set", std::move(params)).map(value_from);
}

Attempt<AxisUnits> GatewayTarget::units(const std::string& axis) {
  return call("axis.get_units", {{"axis", axis}}).map([&](const json::object& row) {
    return AxisUnits{axis,
                     tmcl::find_model(text_at(row, "model")),
                     module_units_from(row),
                     scale_from(row),
                     limits_from(row),
                     number_at(row, "encoder_counts_per_unit")};
  });
}

Attempt<StartedMove> GatewayTarget::move(std::string_view method, json::object params) {
  params["deadline_ms"] = move_deadline_ms;
  return call(method, std::move(params)).map([](const json::object& moved) {
    return StartedMove{{integer_at<std::int32_t>(moved, "target_microsteps")},
                       number_at(moved, "predicted_s"),
                       in_unit_at(moved, "target")};
  });
}

Attempt<StartedMove> GatewayTarget::move_to(const std::string& axis, const Typed& position) {
  json::object params{{"axis", axis}};
  put(params, "position", "position_microsteps", position);
  return move("axis.move_to", std::move(params));
}

Attempt<StartedMove> GatewayTarget::move_by(const std::string& axis, const Typed& distance) {
  json::object params{{"axis", axis}};
  put(params, "distance", "distance_microsteps", distance);
  return move("axis.move_by", std::move(params));
}

Attempt<Turning> GatewayTarget::rotate(const std::string& axis, const Typed& velocity) {
  json::object params{{"axis", axis}, {"deadline_ms", move_deadline_ms}};
  put(params, "velocity", "velocity_internal", velocity);
  return call("axis.rotate", std::move(params)).map([](const json::object& turning) {
    return Turning{{integer_at<std::int32_t>(turning, "velocity_internal")},
                   in_unit_at(turning, "velocity")};
  });
}

Attempt<void> GatewayTarget::stop(const std::string& axis) {
  return call("axis.stop", {{"axis", axis}}).map([](const json::object&) {});
}

void GatewayTarget::stop_motors(const ModuleRow& module, std::vector<StoppedAxis>& stopped) {
  for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
    StoppedAxis row{axis_name({tmcl::ModuleAddress{module.address}, motor}), {}, {}};
    const auto before = host_.now();
    const auto result = stop(row.axis);
    const std::chrono::duration<double, std::milli> took = host_.now() - before;
    if (result) {
      row.milliseconds = took.count();
    } else {
      row.failure = result.error();
    }
    stopped.push_back(std::move(row));
  }
}

Attempt<std::vector<StoppedAxis>> GatewayTarget::stop_found() {
  std::vector<StoppedAxis> stopped;
  for (std::uint16_t first = 1; first <= stop_scan_last; first += stop_scan_step) {
    const auto last = static_cast<std::uint16_t>(first + stop_scan_step - 1);
    const auto found = scan({first, std::min(last, stop_scan_last)}, {});
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().failure);
    for (const auto& module : found->modules) stop_motors(module, stopped);
  }
  return stopped;
}

Attempt<std::vector<StoppedAxis>> GatewayTarget::stop_all() {
  if (axes_from_ == AxesFrom::scan) return stop_found();
  return call("system.stop_all", {}).map([](const json::object& result) {
    auto stopped = rows_at<StoppedAxis>(result, "stopped", [](const json::object& row) {
      return StoppedAxis{text_at(row, "axis"), number_at(row, "milliseconds"), {}};
    });
    for (auto& row : rows_at<StoppedAxis>(result, "failed", [](const json::object& failed) {
           return StoppedAxis{text_at(failed, "axis"), {}, failure_at(failed)};
         })) {
      stopped.push_back(std::move(row));
    }
    return stopped;
  });
}

AxisReading GatewayTarget::reading_from(const json::object& state) const {
  AxisReading reading;
  reading.position = {integer_at<std::int32_t>(state, "position_microsteps")};
  reading.velocity = {integer_at<std::int32_t>(state, "velocity_internal")};
  reading.velocity_pps = number_at(state, "velocity_pps");
  reading.target = {integer_at<std::int32_t>(state, "target_microsteps")};
  reading.position_reached = flag_at(state, "position_reached");
  reading.moving = flag_at(state, "moving");
  if (const auto position = number_at(state, "position")) {
    reading.user = {text_at(state, "unit"), *position, number_at(state, "target").value_or(0),
                    number_at(state, "velocity")};
  }
  const std::chrono::duration<double, std::milli> age(number_at(state, "age_ms").value_or(0));
  reading.age = std::chrono::duration_cast<tmcl::Duration>(age);
  reading.taken_at = host_.now() - reading.age;
  return reading;
}

Attempt<AxisReading> GatewayTarget::state(const std::string& axis) {
  return call("axis.get_state", {{"axis", axis}}).map([&](const json::object& state) {
    return reading_from(state);
  });
}

Attempt<void> GatewayTarget::watch(const std::string& axis, tmcl::Duration interval,
                                   const ReadingHandler& on_reading) {
  bool wanted = true;
  auto heard_at = host_.now();
  door_->on_notification([&](std::string_view method, const json::object& params) {
    if (method != "notify_state" || text_at(params, "axis") != axis) return;
    heard_at = host_.now();
    const auto reading = reading_from(params);
    if (wanted) wanted = on_reading(&reading);
  });
  const auto interval_ms = std::chrono::duration_cast<std::chrono::milliseconds>(interval).count();
  const auto subscribed =
      call("subscribe", {{"axes", json::array{axis}}, {"interval_ms", interval_ms}});
  if (!subscribed) return tl::unexpected(subscribed.error());
  for (const auto& row : array_at(*subscribed, "failed")) {
    return tl::unexpected(failure_at(row.is_object() ? row.get_object() : json::object{}));
  }
  for (const auto& row : array_at(*subscribed, "states")) {
    const auto reading = reading_from(row.is_object() ? row.get_object() : json::object{});
    if (wanted) wanted = on_reading(&reading);
  }
  while (wanted) {
    auto listened = door_->listen(longest_silence);
    if (!listened && listened.error().name != tmcl::client::error_name::cancelled) return listened;
    if (wanted) wanted = on_reading(nullptr);
    if (!wanted || host_.now() - heard_at < doubtful_silence) continue;
    // Nothing comes from an axis that stands, and neither from one that is gone.
    const auto reading = state(axis);
    if (!reading && host_.signal() == 0) return tl::unexpected(reading.error());
    heard_at = host_.now();
  }
  door_->on_notification({});
  return {};
}

Attempt<json::object> GatewayTarget::bus_named(const std::string& name) {
  const auto listed = call("bus.list", {});
  if (!listed) return tl::unexpected(listed.error());
  std::string names;
  const auto& buses = array_at(*listed, "buses");
  for (const auto& value : buses) {
    const auto& bus = value.is_object() ? value.get_object() : json::object{};
    if (text_at(bus, "name") == name || (name.empty() && buses.size() == 1)) return bus;
    names += (names.empty() ? "" : ", ") + text_at(bus, "name");
  }
  if (name.empty()) {
    return tl::unexpected(
        usage_failure("missing_bus", "tmcld has several buses: which one?", "--bus " + names));
  }
  return tl::unexpected(
      usage_failure("unknown_bus", fmt::format("tmcld has no bus '{}'", name), "It has: " + names));
}

Attempt<json::object> GatewayTarget::perform(const std::string& method, json::object params,
                                             const NewsHandler& on_news) {
  if (params.contains("address")) {
    const auto bus = bus_named(text_at(params, "bus"));
    if (!bus) return tl::unexpected(bus.error());
    params["bus"] = text_at(*bus, "name");
  }
  if (!on_news) return call(method, std::move(params));
  // Whether it is wanted any more is asked of Options::cancelled.
  door_->on_notification([&](std::string_view notification, const json::object& news) {
    if (notification == "notify_progress") on_news(news);
  });
  auto result = call(method, std::move(params));
  door_->on_notification({});
  return result;
}

Attempt<json::object> GatewayTarget::params_for(const ModuleName& module) {
  return bus_named(module.bus).map([&](const json::object& bus) {
    return json::object{{"bus", text_at(bus, "name")}, {"address", module.address}};
  });
}

Attempt<tmcl::FirmwareMatch> GatewayTarget::match_firmware(const ModuleName& module,
                                                           const tmcl::firmware::Image& image) {
  auto params = params_for(module);
  if (!params) return tl::unexpected(params.error());
  return call("firmware.status", std::move(*params)).map([&](const json::object& status) {
    return match_from(status, "running", image);
  });
}

Attempt<tmcl::FirmwareReport> GatewayTarget::upload_firmware(const ModuleName& module,
                                                             const tmcl::firmware::Image& image,
                                                             const tmcl::FirmwareOptions& options) {
  auto params = params_for(module);
  if (!params) return tl::unexpected(params.error());
  const auto staged = stage(*door_, "firmware.stage", image.bytes);
  if (!staged) return tl::unexpected(staged.error());
  (*params)["start"] = image.start;
  (*params)["bytes"] = image.bytes.size();
  (*params)["force"] = options.force;
  door_->on_notification([&](std::string_view method, const json::object& news) {
    if (method != "notify_progress" || !options.progress) return;
    options.progress({text_at(news, "phase"), integer_at<std::size_t>(news, "done"),
                      integer_at<std::size_t>(news, "of")});
  });
  const auto done =
      door_->call("firmware.upload", std::move(*params), {.timeout = longest_firmware_step});
  door_->on_notification({});
  return done.map([&](const json::object& report) {
    return tmcl::FirmwareReport{match_from(report, "before", image), version_at(report, "running"),
                                integer_at<std::uint32_t>(report, "checksum")};
  });
}

Attempt<json::object> GatewayTarget::perform_watched(const std::string& method, json::object params,
                                                     const std::string* text,
                                                     const Watcher& watcher) {
  const CallOptions options{longest_path_silence, watcher.meanwhile};
  if (text != nullptr && text->empty()) params["text"] = "";
  if (text != nullptr && !text->empty()) {
    const std::vector<std::uint8_t> bytes(text->begin(), text->end());
    const auto staged = stage(*door_, "path.stage", bytes, options);
    if (!staged) return tl::unexpected(staged.error());
    params["bytes"] = bytes.size();
  }
  door_->on_notification([&](std::string_view notification, const json::object& news) {
    if (notification == "notify_progress" && watcher.on_news) watcher.on_news(news);
  });
  auto result = door_->call(method, std::move(params), options);
  door_->on_notification({});
  return result;
}

Attempt<void> GatewayTarget::hear_arrivals(const ModuleName& module,
                                           const std::function<Attempt<void>()>& ask,
                                           const ArrivalHandler& on_arrival) {
  const auto named = params_for(module);
  if (!named) return tl::unexpected(named.error());
  // Whoever subscribes, to no axis even, is told of events.
  const auto subscribed = call("subscribe", {{"axes", json::array{}}});
  if (!subscribed) return tl::unexpected(subscribed.error());
  auto result = ask();
  bool wanted = true;
  door_->on_notification([&](std::string_view method, const json::object& event) {
    const bool concerns_us = method == "notify_event" &&
                             text_at(event, "kind") == "target_reached" &&
                             text_at(event, "bus") == text_at(*named, "bus") &&
                             integer_at<std::uint16_t>(event, "address") == module.address;
    if (!concerns_us || !wanted) return;
    std::vector<std::uint8_t> motors;
    for (const auto& motor : array_at(event, "motors"))
      motors.push_back(static_cast<std::uint8_t>(motor.to_number<unsigned>()));
    wanted = on_arrival(&motors);
  });
  while (result && wanted) {
    result = door_->listen(longest_silence);
    if (!result && result.error().name == tmcl::client::error_name::cancelled)
      result = Attempt<void>{};
    if (wanted) wanted = on_arrival(nullptr);
  }
  door_->on_notification({});
  return result;
}

Attempt<RawAnswer> GatewayTarget::raw(const RawCommand& command) {
  const auto bus = bus_named(command.bus);
  if (!bus) return tl::unexpected(bus.error());
  const auto& request = command.request;
  const auto result = call("module.execute", {{"bus", text_at(*bus, "name")},
                                              {"address", number(request.address)},
                                              {"command", static_cast<int>(request.command)},
                                              {"type", request.type},
                                              {"motor", request.motor},
                                              {"value", request.value}});
  if (!result) return tl::unexpected(result.error());
  RawAnswer answer;
  answer.bus = text_at(*bus, "name");
  const bool is_can = text_at(*bus, "link").starts_with("can:");
  answer.framing = is_can ? tmcl::Framing::can : tmcl::Framing::serial;
  answer.reply = {tmcl::default_host_address, reply_byte(request.address),
                  static_cast<tmcl::Status>(integer_at<std::uint8_t>(*result, "status")),
                  request.command, integer_at<std::int32_t>(*result, "value")};
  answer.text = text_at(*result, "text");
  return answer;
}

}  // namespace tmclctl

#include "gateway_target.hpp"

#include <algorithm>
#include <charconv>
#include <deque>
#include <utility>

#include <fmt/format.h>

#include "json_read.hpp"
#include "options/form.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/hex.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// A movement that had to wait longer than this for its turn is not what the user expects any more.
constexpr int move_deadline_ms = 5000;
// How often the watching verb gets to look at the clock and at signals when nothing changes.
constexpr auto longest_silence = std::chrono::milliseconds(100);
// An axis that says nothing for so long while it is watched is asked whether it is still there.
constexpr auto doubtful_silence = std::chrono::seconds(1);
// Of one call that waits: shorter than any client waits for an answer.
constexpr tmcl::Duration longest_wait_call = std::chrono::seconds(5);
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
api::NameOrNumber parameter_value(const std::string& text) {
  if (const auto number = parse_number<std::int32_t>(text)) return *number;
  return text;
}

// A method takes one of two parameters: what a module counts, or a number with its unit.
std::optional<std::int32_t> counted_in(const Typed& typed) {
  const auto number = parse_number<std::int32_t>(typed.text);
  return typed.internal && number ? std::optional(*number) : std::nullopt;
}
std::optional<api::Amount> amount_in(const Typed& typed) {
  return counted_in(typed) ? std::nullopt : std::optional<api::Amount>(typed.text);
}

std::int32_t in_milliseconds(tmcl::Duration interval) {
  return static_cast<std::int32_t>(std::chrono::round<std::chrono::milliseconds>(interval).count());
}

std::string or_empty(const std::optional<std::string>& text) { return text.value_or(""); }

template <class Module>
ModuleRow module_from(const Module& found) {
  ModuleRow row;
  row.bus = found.bus;
  row.address = found.address;
  row.model = or_empty(found.model);
  row.model_number = found.model_number.value_or(0);
  row.firmware = or_empty(found.firmware);
  row.axes = found.axes.value_or(0);
  row.duplicate_suspected = found.duplicate_suspected;
  if constexpr (requires { found.state; }) {
    row.state = found.state;
    row.watched_by = found.watched_by;
    row.deadman = api::write_value(found.deadman);
    row.in_bootloader = found.state == "in_bootloader";
  } else {
    row.in_bootloader = found.in_bootloader;
    row.address_is_reply_id = found.address_is_reply_id;
  }
  return row;
}

template <class Module>
std::vector<ModuleRow> modules_from(const std::vector<Module>& found) {
  std::vector<ModuleRow> rows;
  for (const auto& module : found) rows.push_back(module_from(module));
  return rows;
}

std::optional<tmcl::UserScale> scale_from(const api::axis::Units& units) {
  const auto microsteps = units.microsteps_per_revolution.value_or(0);
  if (microsteps <= 0) return std::nullopt;
  // A tmcld that knows of no gears tells the second one only.
  const auto of_turn =
      units.units_per_output_revolution.value_or(units.units_per_revolution.value_or(1));
  return tmcl::UserScale{or_empty(units.unit),
                         of_turn,
                         units.reverse.value_or(false),
                         {microsteps, 0},
                         units.gear_ratio.value_or(1)};
}

std::optional<tmcl::SoftLimits> limits_from(std::optional<double> least,
                                            std::optional<double> greatest) {
  if (!least || !greatest) return std::nullopt;
  return tmcl::SoftLimits{{*least}, {*greatest}};
}

AxisUnits units_from(const api::axis::Units& units, const std::string& axis) {
  AxisUnits out{axis,
                tmcl::find_model(or_empty(units.model)),
                {},
                scale_from(units),
                units.unit ? limits_from(units.soft_limit_minimum, units.soft_limit_maximum)
                           : limits_from(units.soft_limit_minimum_microsteps,
                                         units.soft_limit_maximum_microsteps),
                units.encoder_counts_per_unit};
  if (units.velocity_unit_pps && units.acceleration_unit_pps2)
    out.module = {{*units.velocity_unit_pps}, {*units.acceleration_unit_pps2}};
  return out;
}

tmcl::FirmwareMatch match_from(std::uint16_t model, const std::string& running,
                               const tmcl::firmware::Image& image) {
  tmcl::FirmwareMatch match;
  match.model = model;
  match.running = tmcl::version_from_text(running).value_or(tmcl::FirmwareVersion{});
  match.in_bootloader = match.running.bootloader;
  match.offered = versions_in(image);
  match.version = version_for(image, match.model);
  return match;
}

Result<void> stage(Door& door, std::string_view method, std::span<const std::uint8_t> bytes,
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

Result<json::object> GatewayTarget::call(std::string_view method, json::object params) {
  return door_->call(method, std::move(params));
}

Result<ScanResult> GatewayTarget::scan(ScanRange range, const Progress& progress) {
  if (progress) {
    door_->on_notification([&](std::string_view method, const json::object& params) {
      if (method != api::progress_notification) return;
      const auto news = api::from_json<api::ScanProgress>(params);
      progress(news.bus, news.asked, news.of);
    });
  }
  const auto found = door_->call(api::bus::Scan{{}, range.first, range.last});
  door_->on_notification({});
  return found.map([](const api::bus::FoundModules& all) {
    ScanResult result{modules_from(all.modules), {}};
    for (const auto& [bus, error] : all.failed)
      result.failed.push_back({bus, tmcl::client::error_from_json(error)});
    return result;
  });
}

Result<std::vector<ModuleRow>> GatewayTarget::modules() {
  if (axes_from_ == AxesFrom::scan) {
    auto found = scan({}, {});
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().failure);
    return std::move(found->modules);
  }
  return door_->call(api::module::List{}).map([](const api::module::Modules& found) {
    return modules_from(found.modules);
  });
}

Result<std::vector<AxisRow>> GatewayTarget::found_axes() {
  return modules().map([this](const std::vector<ModuleRow>& found) {
    std::vector<AxisRow> rows;
    for (const auto& module : found) {
      for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
        const auto name = axis_name({tmcl::ModuleAddress{module.address}, motor});
        auto& row = rows.emplace_back(
            AxisRow{{name, module.bus, module.address, motor, {}, "ready", {}, {}}});
        if (!module.model.empty()) row.model = module.model;
        if (const auto now = state(name)) row.faults = now->faults;
      }
    }
    return rows;
  });
}

Result<std::vector<AxisRow>> GatewayTarget::axes() {
  if (axes_from_ == AxesFrom::scan) return found_axes();
  const auto found = door_->call(api::axis::List{});
  if (!found) return tl::unexpected(found.error());
  std::vector<AxisRow> rows;
  for (const auto& axis : found->axes) rows.push_back({axis});
  if (std::ranges::count(rows, unknown_state, &AxisRow::state) != 0) add_reasons(rows);
  return rows;
}

/// For axes whose bus is not open. They are listed all the same if tmcld cannot say more.
void GatewayTarget::add_reasons(std::vector<AxisRow>& axes) {
  const auto listed = door_->call(api::bus::List{});
  if (!listed) return;
  for (const auto& bus : listed->buses) {
    if (bus.state == "open") continue;
    for (auto& axis : axes) {
      if (axis.bus == bus.name && axis.state == unknown_state)
        axis.why = bus.error.value_or("it is being opened");
    }
  }
}

Result<std::vector<api::parameter::Parameter>> GatewayTarget::parameters(const std::string& axis) {
  return door_->call(api::parameter::List{axis}).map([](const api::parameter::Parameters& found) {
    return found.parameters;
  });
}

Result<api::parameter::Held> GatewayTarget::get(const std::string& axis,
                                                const std::string& parameter) {
  return door_->call(api::parameter::Get{{axis, parameter_value(parameter)}})
      .map([](const api::parameter::Value& value) {
        return api::parameter::Held{value, {}};
      });
}

Result<api::parameter::Held> GatewayTarget::set(const std::string& axis,
                                                const std::string& parameter, const Typed& value) {
  return door_->call(
      api::parameter::Set{{axis, parameter_value(parameter)}, counted_in(value), amount_in(value)});
}

Result<AxisUnits> GatewayTarget::units(const std::string& axis) {
  return door_->call(api::axis::GetUnits{axis}).map([&](const api::axis::Units& units) {
    return units_from(units, axis);
  });
}

Result<api::axis::StartedMove> GatewayTarget::move_to(const std::string& axis,
                                                      const Typed& position) {
  return door_->call(
      api::axis::MoveTo{axis, counted_in(position), amount_in(position), {}, move_deadline_ms});
}

Result<api::axis::StartedMove> GatewayTarget::move_by(const std::string& axis,
                                                      const Typed& distance) {
  return door_->call(
      api::axis::MoveBy{axis, counted_in(distance), amount_in(distance), {}, move_deadline_ms});
}

Result<api::axis::Turning> GatewayTarget::rotate(const std::string& axis, const Typed& velocity,
                                                 bool unattended) {
  return door_->call(api::axis::Rotate{axis, counted_in(velocity), amount_in(velocity), unattended,
                                       move_deadline_ms});
}

Result<void> GatewayTarget::stop(const std::string& axis) {
  return door_->call(api::axis::Stop{axis}).map([](const api::Nothing&) {});
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

Result<std::vector<StoppedAxis>> GatewayTarget::stop_found() {
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

Result<std::vector<StoppedAxis>> GatewayTarget::stop_all() {
  if (axes_from_ == AxesFrom::scan) return stop_found();
  return door_->call(api::system::StopAll{}).map([](const api::system::StoppedAxes& result) {
    std::vector<StoppedAxis> rows;
    for (const auto& [axis, milliseconds] : result.stopped)
      rows.push_back({axis, milliseconds, {}});
    for (const auto& [axis, error] : result.failed)
      rows.push_back({axis, {}, tmcl::client::error_from_json(error)});
    return rows;
  });
}

AxisReading GatewayTarget::reading_from(const api::axis::State& state) const {
  return {state, host_.now() - std::chrono::milliseconds(state.age_ms)};
}

Result<AxisReading> GatewayTarget::state(const std::string& axis) {
  return door_->call(api::axis::GetState{axis}).map([&](const api::axis::State& state) {
    return reading_from(state);
  });
}

Result<void> GatewayTarget::watch(const std::string& axis, tmcl::Duration interval,
                                  const ReadingHandler& on_reading) {
  bool wanted = true;
  auto heard_at = host_.now();
  door_->on_notification([&](std::string_view method, const json::object& params) {
    if (method != api::NewState::notification) return;
    const auto news = api::from_json<api::NewState>(params);
    heard_at = host_.now();
    const auto reading = reading_from(news);
    if (wanted) wanted = on_reading(&reading);
  });
  const auto subscribed = door_->call(api::Subscribe{{{axis}}, in_milliseconds(interval)});
  if (!subscribed) return tl::unexpected(subscribed.error());
  for (const auto& failed : subscribed->failed)
    return tl::unexpected(tmcl::client::error_from_json(failed.error));
  for (const auto& state : subscribed->states) {
    const auto reading = reading_from(state);
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

/// Asked anew every few seconds: a gateway that says nothing any more is noticed.
Result<Warnings> GatewayTarget::await_standing(const Wait& wait) {
  using std::chrono::milliseconds;
  const auto begin = host_.now();
  while (true) {
    const auto left = wait.at_most.value_or(tmcl::Duration::max()) - (host_.now() - begin);
    const auto call_time = std::clamp<tmcl::Duration>(left, shortest_wait, longest_wait_call);
    const api::axis::Wait call{wait.axis, std::chrono::ceil<milliseconds>(call_time).count(),
                               wait.goal.value};
    const auto stands = door_->call(call);
    if (stands) return stands->warnings;
    const bool goes_on =
        stands.error().name == name_of(tmcl::Errc::deadline_passed) && left > longest_wait_call;
    if (!goes_on) return tl::unexpected(stands.error());
  }
}

Result<Warnings> GatewayTarget::wait(const Wait& wait,
                                     const std::function<void(const AxisReading&)>& on_reading) {
  door_->on_notification([&](std::string_view method, const json::object& params) {
    if (method == api::NewState::notification)
      on_reading(reading_from(api::from_json<api::NewState>(params)));
  });
  const auto subscribed =
      door_->call(api::Subscribe{{{wait.axis}}, in_milliseconds(wait.interval)});
  if (!subscribed) {
    door_->on_notification({});
    return tl::unexpected(subscribed.error());
  }
  for (const auto& now : subscribed->states) on_reading(reading_from(now));
  auto stands = await_standing(wait);
  door_->on_notification({});
  // Nobody is there any more, or nobody wants to know.
  if (!stands && (exit_code_of(stands.error()) != ExitCode::not_reached || host_.signal() != 0))
    return stands;
  const auto last = state(wait.axis);
  if (last) on_reading(*last);
  if (stands && !last) return tl::unexpected(last.error());
  const api::Unsubscribe unsubscribe{static_cast<std::int32_t>(subscribed->subscription)};
  const auto ended = door_->call(unsubscribe);
  if (stands && !ended) return tl::unexpected(ended.error());
  return stands;
}

Result<void> GatewayTarget::watch_axes(const std::vector<std::string>& axes,
                                       tmcl::Duration interval, const AxesWatcher& watcher) {
  // What a handler asks is answered while the next notifications come, so they wait for their turn.
  std::deque<std::pair<std::string, json::object>> news;
  door_->on_notification([&](std::string_view method, const json::object& params) {
    news.emplace_back(method, params);
  });
  const auto hand_out = [&] {
    for (; !news.empty(); news.pop_front()) {
      const auto& [method, params] = news.front();
      if (method == api::NewState::notification && watcher.on_reading) {
        const auto state = api::from_json<api::NewState>(params);
        watcher.on_reading(state.axis, reading_from(state));
      }
      if (method == api::Event::notification && watcher.on_event) watcher.on_event(params);
    }
  };
  api::Subscribe subscribe{.interval_ms = in_milliseconds(interval)};
  if (!axes.empty()) subscribe.axes = axes;
  const auto subscribed = door_->call(subscribe);
  auto result = subscribed.map([](const auto&) {});
  if (subscribed) {
    for (const auto& state : subscribed->states)
      if (watcher.on_reading) watcher.on_reading(state.axis, reading_from(state));
    for (const auto& [axis, error] : subscribed->failed)
      if (watcher.on_failure) watcher.on_failure(axis, tmcl::client::error_from_json(error));
  }
  while (result && watcher.wanted()) {
    result = door_->listen(longest_silence);
    hand_out();
  }
  door_->on_notification({});
  return result;
}

Result<api::bus::Bus> GatewayTarget::bus_named(const std::string& name) {
  const auto listed = door_->call(api::bus::List{});
  if (!listed) return tl::unexpected(listed.error());
  std::string names;
  for (const auto& bus : listed->buses) {
    if (bus.name == name || (name.empty() && listed->buses.size() == 1)) return bus;
    names += (names.empty() ? "" : ", ") + bus.name;
  }
  if (name.empty()) {
    return tl::unexpected(
        usage_error("missing_bus", "tmcld has several buses: which one?", "--bus " + names));
  }
  return tl::unexpected(
      usage_error("unknown_bus", fmt::format("tmcld has no bus '{}'", name), "It has: " + names));
}

Result<json::object> GatewayTarget::perform(const std::string& method, json::object params,
                                            const NewsHandler& on_news) {
  if (params.contains("address")) {
    const auto bus = bus_named(text_at(params, "bus"));
    if (!bus) return tl::unexpected(bus.error());
    params["bus"] = bus->name;
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

Result<api::OnModule> GatewayTarget::params_for(const ModuleName& module) {
  return bus_named(module.bus).map([&](const api::bus::Bus& bus) {
    return api::OnModule{bus.name, module.address};
  });
}

Result<tmcl::FirmwareMatch> GatewayTarget::match_firmware(const ModuleName& module,
                                                          const tmcl::firmware::Image& image) {
  const auto named = params_for(module);
  if (!named) return tl::unexpected(named.error());
  return door_->call(api::firmware::Status{{*named}})
      .map([&](const api::firmware::FirmwareState& status) {
        return match_from(status.model_number, status.running, image);
      });
}

Result<tmcl::FirmwareReport> GatewayTarget::upload_firmware(const ModuleName& module,
                                                            const tmcl::firmware::Image& image,
                                                            const tmcl::FirmwareOptions& options) {
  const auto named = params_for(module);
  if (!named) return tl::unexpected(named.error());
  const auto staged = stage(*door_, api::firmware::Stage::method.name, image.bytes);
  if (!staged) return tl::unexpected(staged.error());
  door_->on_notification([&](std::string_view method, const json::object& params) {
    if (method != api::progress_notification || !options.progress) return;
    const auto news = api::from_json<api::LoadProgress>(params);
    options.progress({news.phase, news.done, news.of});
  });
  const auto size = static_cast<std::uint32_t>(image.bytes.size());
  const api::firmware::Upload upload{*named, image.start, size, options.force};
  const auto done = door_->call(upload, {.timeout = longest_firmware_step});
  door_->on_notification({});
  return done.map([&](const api::firmware::Exchange& report) {
    const auto running = tmcl::version_from_text(report.running);
    return tmcl::FirmwareReport{match_from(report.model_number, report.before, image),
                                running.value_or(tmcl::FirmwareVersion{}), report.checksum};
  });
}

Result<json::object> GatewayTarget::perform_watched(const std::string& method, json::object params,
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

Result<void> GatewayTarget::hear_arrivals(const ModuleName& module,
                                          const std::function<Result<void>()>& ask,
                                          const ArrivalHandler& on_arrival) {
  const auto named = params_for(module);
  if (!named) return tl::unexpected(named.error());
  // Whoever subscribes, to no axis even, is told of events.
  const auto subscribed = door_->call(api::Subscribe{std::vector<std::string>{}});
  if (!subscribed) return tl::unexpected(subscribed.error());
  auto result = ask();
  bool wanted = true;
  door_->on_notification([&](std::string_view method, const json::object& params) {
    if (method != api::Event::notification || !wanted) return;
    const auto event = api::from_json<api::Event>(params);
    const bool concerns_us = event.kind == "target_reached" && event.bus == named->bus &&
                             event.address == module.address;
    if (!concerns_us) return;
    const auto motors = event.motors.value_or(std::vector<std::uint8_t>{});
    wanted = on_arrival(&motors);
  });
  while (result && wanted) {
    result = door_->listen(longest_silence);
    if (!result && result.error().name == tmcl::client::error_name::cancelled)
      result = Result<void>{};
    if (wanted) wanted = on_arrival(nullptr);
  }
  door_->on_notification({});
  return result;
}

Result<RawAnswer> GatewayTarget::raw(const RawCommand& command) {
  const auto bus = bus_named(command.bus);
  if (!bus) return tl::unexpected(bus.error());
  const auto& request = command.request;
  api::module::Execute execute{{{bus->name, number(request.address)}},
                               static_cast<std::int32_t>(request.command)};
  execute.type = request.type;
  execute.motor = request.motor;
  execute.value = request.value;
  const auto result = door_->call(execute);
  if (!result) return tl::unexpected(result.error());
  RawAnswer answer;
  answer.bus = bus->name;
  const bool is_can = bus->link.starts_with("can:");
  answer.framing = is_can ? tmcl::Framing::can : tmcl::Framing::serial;
  answer.reply = {tmcl::default_host_address, reply_byte(request.address),
                  static_cast<tmcl::Status>(result->status), request.command, result->value};
  answer.text = or_empty(result->text);
  answer.warnings = result->warnings.value_or(std::vector<std::string>());
  return answer;
}

}  // namespace tmclctl

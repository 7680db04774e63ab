// tmclctl without a process around it: an axis that moves in virtual time, and the output as text.
#pragma once

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <boost/json.hpp>

#include "axis/axis_names.hpp"
#include "axis/quantity_text.hpp"
#include "command_line/tmclctl.hpp"
#include "tmcl/api/lease.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/firmware_verbs.hpp"
#include "tmcl/hex.hpp"
#include "unit/ctl_host.hpp"
#include "verbs/verbs.hpp"

namespace tmclctl {

/// An error that ends with this exit code, where the outcome leaves that open.
inline Error error_of(ExitCode exit, std::string name, std::string message, std::string hint = {},
                      std::optional<tmcl::Outcome> outcome = {}) {
  using tmcl::Outcome;
  Error error{std::move(name), ErrorKind::failed, Outcome::unknown, std::move(message),
              std::move(hint)};
  if (exit == ExitCode::refused) error.outcome = Outcome::refused;
  if (exit == ExitCode::not_sent) error.outcome = Outcome::not_sent;
  if (exit == ExitCode::not_reached) error.kind = ErrorKind::ended_early;
  if (exit == ExitCode::interrupted) error.kind = ErrorKind::interrupted;
  if (exit == ExitCode::usage) error.kind = ErrorKind::bad_request;
  error.outcome = outcome.value_or(error.outcome);
  return error;
}

}  // namespace tmclctl

namespace tmclctl::test {

namespace api = tmcl::api;

/// What an axis with a unit tells beside what its module counts.
struct UserReading {
  std::string unit;
  double position = 0;
  double target = 0;
  std::optional<double> velocity;

  void put_into(AxisReading& reading) const {
    reading.unit = unit;
    reading.position = position;
    reading.target = target;
    reading.velocity = velocity;
  }
};

/// As tmcld says it in lists of what failed.
inline boost::json::object said(const Error& error) {
  constexpr int of_bad_request = -32602;
  constexpr int of_failure = -32000;
  return {
      {"code", error.kind == ErrorKind::bad_request ? of_bad_request : of_failure},
      {"message", error.message},
      {"data", {{"name", error.name}, {"outcome", name_of(error.outcome)}, {"hint", error.hint}}}};
}

/// A gateway with one bus "b" and one axis "x" that moves at a constant rate. Every module is a
/// TMCM-1110, as far as firmware goes.
class FakeGateway final : public tmcl::client::Channel {
 public:
  struct Stopped {
    std::string axis;
    std::optional<double> milliseconds;
    std::optional<Error> error;
  };

  explicit FakeGateway(Host& host) : host_(host) {}

  // What the tests arrange.
  std::int32_t microsteps_per_ms = 10;
  std::optional<Error> failure;                          ///< What every call ends with.
  std::optional<tmcl::Duration> stopped_by_other_after;  ///< Since the move began.
  std::vector<Stopped> stopped;
  ScanResult found;
  std::optional<double> predicted_s;  ///< What every move is said to take.
  tmcl::AxisUnits counts{"x", tmcl::find_model("TMCM-1110"),
                         tmcl::module_units(tmcl::Tmc429Dividers{2, 3}),
                         tmcl::UserScale{"mm", 5, false, {200, 8}}};
  std::optional<UserReading> user;                  ///< What axis.get_state gives.
  std::optional<InUnit> told_in_unit;               ///< What moves, turns and parameters tell.
  bool tells_position_in_mm = false;                ///< Gives a user, 10240 microsteps a mm.
  std::map<std::string, std::int32_t> values;       ///< Of parameters, as asked for.
  std::string known_axis;                           ///< Empty: all of them.
  std::string refused_parameter;                    ///< It cannot be set.
  std::optional<std::string> stop_cause;            ///< Of stopped_by_other_after.
  std::optional<tmcl::TimePoint> stopped_at{};      ///< Then last_stop grows.
  std::optional<Error> renewal_failure;             ///< What lease.renew ends with.
  std::optional<Error> stop_failure;                ///< Of axis.stop only.
  Warnings warnings;                                ///< Of parameter.set and of waits.
  std::string closed_because;                       ///< Why the bus of all axes is not open.
  tmcl::FirmwareVersion runs_then{1110, 1, 42};     ///< After an upload.
  std::vector<api::Event> events;                   ///< Told once.
  int losses = 0;                                   ///< So often tmcld goes away,
  int away_for = 0;                                 ///< and it is asked for so often in vain.
  std::deque<boost::json::object> results;          ///< One after the other, before `result`.
  boost::json::object result;                       ///< Of every method that is none of the axis.
  std::vector<std::vector<std::uint8_t>> arrivals;  ///< One a second.
  std::vector<boost::json::object> news{
      boost::json::object{{"phase", "running"}, {"passed_s", 0.5}}};
  std::optional<Error> run_failure;
  std::optional<Error> plan_failure;
  boost::json::object plan;

  // What happened.
  std::vector<std::string> calls;
  std::string said;      ///< The position, distance or velocity of the last call.
  std::string run_text;  ///< What was handed over last.

  Result<boost::json::object> call(std::string_view method, boost::json::object params,
                                   const tmcl::client::CallOptions& options) override {
    // A refused verb asks this to explain itself.
    if (method == api::parameter::List::method.name) return api::to_json(parameters());
    if (failure) return tl::unexpected(*failure);
    const auto handler = handlers_.find(method);
    if (handler != handlers_.end()) return handler->second(params);
    if (method == api::path::Run::method.name || method == api::mint::Run::method.name)
      return run(method, params, options);
    return answer(method, params);
  }
  /// An interval passes, or an event comes.
  Result<void> listen(tmcl::Duration) override {
    if (host_.signal() != 0) return tl::unexpected(cancelled());
    for (const auto& event : std::exchange(events, {}))
      tell(api::Event::notification, api::to_json(event));
    if (losses > 0) {
      --losses;
      return tl::unexpected(away());
    }
    if (!arrivals.empty()) {
      host_.sleep(std::chrono::seconds(1));
      api::Event event;
      event.kind = "target_reached";
      event.bus = bus_name;
      event.address = 1;
      event.motors = arrivals.front();
      arrivals.erase(arrivals.begin());
      tell(api::Event::notification, api::to_json(event));
      return {};
    }
    host_.sleep(interval_);
    tell_states();
    return {};
  }
  void on_notification(Listener listener) override { listener_ = std::move(listener); }
  Result<void> reopen() override {
    if (away_for-- > 0) return tl::unexpected(away());
    return {};
  }
  std::string version() const override { return {}; }

  void move_to(std::int32_t position) { go("x", {std::to_string(position)}, 0); }

 private:
  static constexpr const char* bus_name = "b";
  using Handler = std::function<Result<boost::json::object>(const boost::json::object&)>;

  static Error away() {
    return error_of(ExitCode::not_sent, std::string(tmcl::client::error_name::lost),
                    "tmcld has gone");
  }
  static Error cancelled() {
    return error_of(ExitCode::interrupted, std::string(tmcl::client::error_name::cancelled),
                    "interrupted");
  }

  template <class Method>
  std::pair<const std::string_view, Handler> on(
      Result<typename Method::Result> (FakeGateway::*handler)(const Method&)) {
    return {Method::method.name, [this, handler](const boost::json::object& params) {
              return (this->*handler)(api::from_json<Method>(params))
                  .map(api::to_json<typename Method::Result>);
            }};
  }

  void tell(std::string_view method, const boost::json::object& params) {
    // It may be another one afterwards.
    const auto listener = listener_;
    if (listener) listener(method, params);
  }
  void tell_states() {
    for (const auto& axis : watched_) {
      api::NewState state;
      publish(axis, state);
      tell(api::NewState::notification, api::to_json(state));
    }
  }
  /// Samples are 5 ms older than the position.
  void publish(const std::string& axis, api::PublishedState& state) const {
    static_cast<api::axis::State&>(state) = state_now(axis);
    for (const auto& name : sampled_) {
      auto& sample = state.samples.emplace_back();
      sample.parameter = name;
      if (const auto value = values.find(name); value != values.end()) sample.value = value->second;
      sample.age_ms = 5;
    }
  }

  /// What a scan and the list of modules have in common.
  static void fill(auto& module, const auto& row) {
    module.bus = row.bus;
    module.address = row.address;
    if (!row.model.empty()) module.model = row.model;
    module.model_number = row.model_number;
    module.firmware = row.firmware;
    module.axes = row.axes;
    module.duplicate_suspected = row.duplicate_suspected;
  }

  Result<api::bus::FoundModules> scan(const api::bus::Scan&) {
    tell(api::progress_notification, {{"bus", "bench"}, {"asked", 16}, {"of", 255}});
    api::bus::FoundModules all{{}, {}, found.silent};
    for (const auto& row : found.modules) {
      auto& module = all.modules.emplace_back();
      fill(module, row);
      module.in_bootloader = row.in_bootloader;
      module.address_is_reply_id = row.address_is_reply_id;
      if (&row == &found.modules.front()) {
        tell(api::progress_notification,
             api::to_json(api::ScanProgress{row.bus, row.address, 255, module}));
      }
    }
    for (const auto& [bus, error] : found.failed) all.failed.push_back({bus, test::said(error)});
    return all;
  }
  Result<api::module::Modules> modules(const api::module::List&) {
    api::module::Modules all;
    for (const auto& row : found.modules) {
      auto& module = all.modules.emplace_back();
      fill(module, row);
      module.state = row.state;
      module.watched_by = row.watched_by;
    }
    return all;
  }
  Result<api::axis::Axes> axes(const api::axis::List&) {
    if (!closed_because.empty()) {
      return api::axis::Axes{
          {{"x", "bench", 1, 0, {}, "unknown", {}}, {"y", "bench", 1, 1, {}, "unknown", {}}}};
    }
    const auto unit = user ? std::optional(user->unit) : std::nullopt;
    return api::axis::Axes{{{"x", "bench", 1, 0, "TMCM-1110", "ready", unit}}};
  }
  Result<boost::json::object> buses(const boost::json::object&) {
    const auto lists_buses = [](const auto& one) { return one.contains("buses"); };
    if (!results.empty() && lists_buses(results.front())) return next_result();
    if (lists_buses(result)) return result;
    api::bus::Bus bus;
    bus.name = closed_because.empty() ? bus_name : "bench";
    bus.link = "serial:/dev/none@115200";
    bus.state = closed_because.empty() ? "open" : "opening";
    if (!closed_because.empty()) bus.error = closed_because;
    return api::to_json(api::bus::Buses{{bus}});
  }
  static api::parameter::Parameters parameters() {
    const std::string both = "read_write";
    return {
        {{4, "max_velocity", both, true, 0, 2047, 1000, "internal", "speed", {}, {"v_max"}},
         {0, "target_position", both, false, -9, 9, 0, "microstep", "where to", {}, {"xtarget"}},
         {3, "actual_velocity", "read", false, -9, 9, 0, "internal", "speed now", {}, {}}}};
  }
  static std::string text_of(const api::NameOrNumber& parameter) {
    const auto* number = std::get_if<std::int32_t>(&parameter.said);
    return number != nullptr ? std::to_string(*number) : std::get<std::string>(parameter.said);
  }
  static std::string text_of(const std::optional<std::int32_t>& counted,
                             const std::optional<api::Amount>& amount) {
    if (counted) return std::to_string(*counted);
    return std::get<std::string>(amount.value().said);
  }
  Result<api::parameter::Value> get(const api::parameter::Get& params) {
    const auto parameter = text_of(params.parameter);
    auto name = parse_parameter(common_parameters(), parameter);
    if (!name && values.contains(parameter)) name = ParameterName{0, parameter};
    if (!name) return tl::unexpected(name.error());
    calls.push_back("get " + params.axis + ' ' + name->name);
    api::parameter::Value value{{name->name, name->number}, -1500, {}, {}};
    if (!values.contains(parameter)) return value;
    value.value = values[parameter];
    if (told_in_unit) value.unit = told_in_unit->unit;
    if (told_in_unit) value.value_in_unit = told_in_unit->value;
    return value;
  }
  Result<api::parameter::Held> set(const api::parameter::Set& params) {
    const auto parameter = text_of(params.parameter);
    const auto text = text_of(params.value, params.value_in_unit);
    calls.push_back("set " + params.axis + ' ' + parameter + ' ' + text);
    if (parameter == refused_parameter)
      return tl::unexpected(error_of(ExitCode::refused, "refused_by_module", "it refused"));
    const auto value = attempt(tmcl::parse_quantity(text));
    if (!value) return tl::unexpected(value.error());
    return api::parameter::Held{
        {{"max_velocity", 4}, static_cast<std::int32_t>(value->number), {}, {}}, warnings};
  }
  Result<api::axis::Units> units(const api::axis::GetUnits& params) {
    calls.push_back("units " + params.axis);
    if (params.axis != known_axis && !known_axis.empty())
      return tl::unexpected(usage_error("unknown_axis", "there is no axis '" + params.axis + "'"));
    api::axis::Units units;
    units.axis = params.axis;
    if (counts.model != nullptr) units.model = counts.model->name;
    if (counts.module) {
      units.velocity_unit_pps = counts.module->velocity.value;
      units.acceleration_unit_pps2 = counts.module->acceleration.value;
    }
    if (counts.scale) {
      if (!counts.scale->unit.empty()) units.unit = counts.scale->unit;
      units.units_per_output_revolution = counts.scale->units_per_revolution;
      units.gear_ratio = counts.scale->gear_ratio;
      units.reverse = counts.scale->reverse;
      units.microsteps_per_revolution = counts.scale->steps.per_revolution();
    }
    units.encoder_counts_per_unit = counts.encoder_counts_per_unit;
    if (counts.limits) {
      units.soft_limit_minimum = counts.limits->least.value;
      units.soft_limit_maximum = counts.limits->greatest.value;
    }
    return units;
  }
  Result<api::axis::StartedMove> move(const api::axis::MoveTo& params) {
    return go(params.axis, typed(params.position_microsteps, params.position), 0);
  }
  Result<api::axis::StartedMove> move_by(const api::axis::MoveBy& params) {
    return go(params.axis, typed(params.distance_microsteps, params.distance), at());
  }
  Result<api::axis::Turning> rotate(const api::axis::Rotate& params) {
    const bool unattended = params.unattended.value_or(false);
    const auto value = counted(typed(params.velocity_internal, params.velocity),
                               tmcl::axis_parameter::target_velocity);
    if (!value) return tl::unexpected(value.error());
    calls.push_back("rotate " + params.axis + ' ' + std::to_string(*value) +
                    (unattended ? " unattended" : ""));
    if (!unattended && *value != 0) {
      constexpr std::int32_t far_away = 1'000'000'000;
      from_ = at();
      target_ = far_away;
      began_ = host_.now();
    }
    api::axis::Turning turning{*value, {}, {}, {}};
    if (told_in_unit) turning.unit = told_in_unit->unit;
    if (told_in_unit) turning.velocity = told_in_unit->value;
    return turning;
  }
  Result<api::Nothing> stop(const api::axis::Stop& params) {
    if (stop_failure) return tl::unexpected(*stop_failure);
    calls.push_back("stop " + params.axis);
    return {};
  }
  Result<api::system::StoppedAxes> stop_all(const api::system::StopAll&) {
    calls.push_back("stop_all");
    api::system::StoppedAxes all;
    for (const auto& row : stopped) {
      if (row.error) {
        all.failed.push_back({row.axis, test::said(*row.error)});
      } else {
        all.stopped.push_back({row.axis, row.milliseconds.value_or(0)});
      }
    }
    return all;
  }
  api::axis::State state_now(const std::string& axis) const {
    AxisReading reading;
    reading.axis = axis;
    reading.position_microsteps = at();
    reading.target_microsteps = target_;
    const auto direction = target_ >= from_ ? 1 : -1;
    reading.moving = at() != target_ && !stopped_now();
    reading.velocity_internal = reading.moving ? 100 * direction : 0;
    reading.position_reached = at() == target_;
    if (stopped_now()) reading.stop_cause = stop_cause;
    reading.last_stop = stopped_at && host_.now() >= *stopped_at ? 1 : 0;
    if (user) user->put_into(reading);
    if (tells_position_in_mm)
      UserReading{"mm", at() / 10'240.0, target_ / 10'240.0, 0.5}.put_into(reading);
    return reading;
  }
  Result<api::axis::State> state(const api::axis::GetState& params) {
    return state_now(params.axis);
  }
  Result<api::Subscription> subscribe(const api::Subscribe& params) {
    watched_ = params.axes.value_or(std::vector<std::string>{"x"});
    interval_ = std::chrono::milliseconds(params.interval_ms.value_or(50));
    sampled_ = params.parameters.value_or(std::vector<std::string>{});
    api::Subscription subscription;
    for (const auto& axis : watched_) {
      publish(axis, subscription.states.emplace_back());
    }
    return subscription;
  }
  Result<api::Nothing> unsubscribe(const api::Unsubscribe&) {
    watched_.clear();
    return {};
  }
  Result<api::axis::Standing> wait(const api::axis::Wait& params) {
    const std::chrono::milliseconds at_most(params.timeout_ms.value());
    const auto begin = host_.now();
    while (true) {
      tell_states();
      if (host_.signal() != 0) return tl::unexpected(cancelled());
      if (at() == params.target_microsteps.value())
        return api::axis::Standing{{at(), {}, {}}, warnings};
      if (stopped_now())
        return tl::unexpected(error_of(ExitCode::not_reached, "move_interrupted", "it stands"));
      if (host_.now() - begin >= at_most)
        return tl::unexpected(error_of(ExitCode::not_reached, "deadline_passed", "it moves"));
      host_.sleep(interval_);
    }
  }
  Result<api::module::Reply> raw(const api::module::Execute& params) {
    api::module::Reply reply{100, "ok", 0, 1000, {}, {}};
    if (std::get<std::int32_t>(params.command.said) == static_cast<int>(tmcl::Command::ROR))
      reply.warnings = {"it turns"};
    return reply;
  }
  Result<api::firmware::FirmwareState> firmware(const api::firmware::Status& params) {
    calls.push_back("firmware.status " + params.bus + ':' + std::to_string(params.address));
    return api::firmware::FirmwareState{{}, 1110, "1110V101", false};
  }
  Result<api::HandedOver> stage_firmware(const api::firmware::Stage& params) {
    return api::HandedOver{params.offset};
  }
  Result<api::HandedOver> stage_path(const api::path::Stage& params) {
    if (params.offset == 0) run_text.clear();
    const auto bytes = tmcl::from_hex(params.data).value();
    run_text.append(bytes.begin(), bytes.end());
    return api::HandedOver{static_cast<std::int32_t>(run_text.size())};
  }
  Result<api::firmware::Exchange> upload(const api::firmware::Upload& params) {
    calls.emplace_back(params.force.value_or(false) ? "firmware.upload by force"
                                                    : "firmware.upload");
    for (const auto* phase : {"erasing", "writing", "starting"})
      tell(api::progress_notification,
           {{"phase", phase}, {"done", params.bytes / 2}, {"of", params.bytes}});
    const auto text = to_text(runs_then);
    return api::firmware::Exchange{{}, 1110, "1110V101", {text.begin(), text.end()}, 0};
  }
  Result<boost::json::object> plan_path(const boost::json::object& params) {
    calls.push_back("path.plan " + boost::json::serialize(params));
    if (plan_failure) return tl::unexpected(*plan_failure);
    return plan;
  }
  Result<boost::json::object> run(std::string_view method, const boost::json::object& params,
                                  const tmcl::client::CallOptions& options) {
    calls.push_back(std::string(method) + ' ' + boost::json::serialize(params));
    for (const auto& one : news) tell(api::progress_notification, one);
    for (int i = 0; i < 20; ++i) {
      host_.sleep(std::chrono::milliseconds(100));
      options.meanwhile();
    }
    if (run_failure) return tl::unexpected(*run_failure);
    return result;
  }
  boost::json::object next_result() {
    auto next = std::move(results.front());
    results.pop_front();
    return next;
  }
  Result<boost::json::object> answer(std::string_view method, const boost::json::object& params) {
    if (method == api::lease::Renew::method.name && renewal_failure)
      return tl::unexpected(*renewal_failure);
    calls.push_back(std::string(method) + ' ' + boost::json::serialize(params));
    tell(api::progress_notification, {{"phase", "writing"}, {"done", 1}, {"of", 2}, {"step", 1}});
    if (host_.signal() != 0) return tl::unexpected(cancelled());
    if (results.empty()) return result;
    return next_result();
  }

  static Typed typed(const std::optional<std::int32_t>& counted,
                     const std::optional<api::Amount>& amount) {
    return {text_of(counted, amount), counted.has_value()};
  }
  /// A number without a unit is what the module counts, although the axis has a unit.
  Result<std::int32_t> counted(const Typed& typed, std::uint8_t parameter) {
    said = typed.text + (typed.internal ? " --internal" : "");
    const auto quantity = attempt(tmcl::parse_quantity(typed.text));
    if (!quantity) return tl::unexpected(quantity.error());
    return attempt(to_parameter(*quantity, quantity->unit.empty() ? tmcl::AxisUnits{"x"} : counts,
                                *find_parameter(counts.parameters(), parameter)));
  }
  Result<api::axis::StartedMove> go(const std::string& axis, const Typed& way, std::int32_t from) {
    const auto microsteps = counted(way, tmcl::axis_parameter::target_position);
    if (!microsteps) return tl::unexpected(microsteps.error());
    const tmcl::Microsteps goal{from + *microsteps};
    calls.push_back("move_to " + axis + ' ' + std::to_string(goal.value));
    from_ = at();
    target_ = goal.value;
    began_ = host_.now();
    api::axis::StartedMove move{goal.value, {}, {}, predicted_s, {}};
    if (told_in_unit) move.unit = told_in_unit->unit;
    if (told_in_unit) move.target = told_in_unit->value;
    return move;
  }
  bool stopped_now() const {
    return stopped_by_other_after && host_.now() - began_ >= *stopped_by_other_after;
  }
  std::int32_t at() const {
    auto elapsed = host_.now() - began_;
    if (stopped_by_other_after) elapsed = std::min(elapsed, *stopped_by_other_after);
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    const auto way = std::abs(std::int64_t{target_} - from_);
    const auto done = std::min<std::int64_t>(way, ms * microsteps_per_ms);
    return static_cast<std::int32_t>(from_ + (target_ >= from_ ? done : -done));
  }

  Host& host_;
  Listener listener_;
  std::vector<std::string> watched_;
  std::vector<std::string> sampled_;
  tmcl::Duration interval_ = std::chrono::milliseconds(50);
  std::int32_t from_ = 0;
  std::int32_t target_ = 0;
  tmcl::TimePoint began_{};
  const std::map<std::string_view, Handler> handlers_{
      on(&FakeGateway::scan),
      on(&FakeGateway::modules),
      on(&FakeGateway::axes),
      {api::bus::List::method.name, [this](const auto& params) { return buses(params); }},
      on(&FakeGateway::get),
      on(&FakeGateway::set),
      on(&FakeGateway::units),
      on(&FakeGateway::move),
      on(&FakeGateway::move_by),
      on(&FakeGateway::rotate),
      on(&FakeGateway::stop),
      on(&FakeGateway::stop_all),
      on(&FakeGateway::state),
      on(&FakeGateway::subscribe),
      on(&FakeGateway::unsubscribe),
      on(&FakeGateway::wait),
      on(&FakeGateway::raw),
      on(&FakeGateway::firmware),
      on(&FakeGateway::stage_firmware),
      on(&FakeGateway::stage_path),
      on(&FakeGateway::upload),
      {api::path::Plan::method.name, [this](const auto& params) { return plan_path(params); }}};
};

/// Runs one command line against the fake axis.
class Ctl {
  FakeHost host_;
  std::unique_ptr<FakeGateway> channel_ = std::make_unique<FakeGateway>(host_);

 public:
  FakeHost& host = host_;
  FakeGateway& target = *channel_;
  Gateway gateway{tmcl::client::Caller(std::move(channel_))};
  Screen screen;  ///< Both streams'. A plain file, unless the test says otherwise.

  std::string out;
  std::string err;

  ExitCode run(const std::vector<std::string>& arguments) {
    std::ostringstream out_stream;
    std::ostringstream err_stream;
    Output output{out_stream, err_stream, screen, screen};
    output.gateway = " --direct can:can0";
    const auto exit = tmclctl::run(arguments, output, host, gateway);
    out = out_stream.str();
    err = err_stream.str();
    return exit;
  }
  /// Runs with --json and reads the one document.
  boost::json::object json(std::vector<std::string> arguments, ExitCode expected = ExitCode::done) {
    arguments.insert(arguments.begin(), "--json");
    const auto exit = run(arguments);
    if (exit != expected) throw std::runtime_error("unexpected exit code; output: " + out + err);
    return boost::json::parse(out).as_object();
  }
};

}  // namespace tmclctl::test

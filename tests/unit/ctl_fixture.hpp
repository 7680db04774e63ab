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

#include "names.hpp"
#include "tmclctl.hpp"
#include "verbs.hpp"

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

/// Time passes only while someone sleeps. May be told to press Ctrl-C at some instant.
class FakeHost final : public Host {
 public:
  tmcl::TimePoint now() const override { return now_; }
  tmcl::UtcTime utc() const override { return tmcl::UtcTime(now_.time_since_epoch()); }
  void sleep(tmcl::Duration duration) override { now_ += std::max(duration, tmcl::Duration{}); }
  void catch_signals() override { caught_ = true; }
  int signal() const override { return caught_ && now_ >= ctrl_c_at_ ? SIGINT : 0; }
  int take_signal() override {
    const int number = signal();
    if (number != 0) ctrl_c_at_ = tmcl::TimePoint::max();
    return number;
  }
  void catch_pauses() override {}
  bool pause_asked() const override { return false; }

  void press_ctrl_c_after(tmcl::Duration duration) { ctrl_c_at_ = now_ + duration; }

 private:
  tmcl::TimePoint now_{std::chrono::hours(1)};
  tmcl::TimePoint ctrl_c_at_ = tmcl::TimePoint::max();
  bool caught_ = false;
};

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

/// One axis "x" that moves at a constant rate. Every module is a TMCM-1110, as far as firmware
/// goes.
class FakeTarget : public Target {
 public:
  explicit FakeTarget(Host& host) : host_(host) {}

  // What the tests arrange.
  std::int32_t microsteps_per_ms = 10;
  std::optional<Error> failure;                          ///< What every call ends with.
  std::optional<tmcl::Duration> stopped_by_other_after;  ///< Since the move began.
  std::vector<StoppedAxis> stopped;
  ScanResult found;
  bool duplicate_readings = false;
  std::optional<double> predicted_s;  ///< What every move is said to take.
  AxisUnits counts{"x", tmcl::find_model("TMCM-1110"),
                   tmcl::module_units(tmcl::Tmc429Dividers{2, 3}),
                   tmcl::UserScale{"mm", 5, false, {200, 8}}};
  std::optional<UserReading> user;               ///< What state() gives.
  std::optional<InUnit> told_in_unit;            ///< What moves, turns and get() tell beside it.
  bool tells_position_in_mm = false;             ///< state() gives a user, 10240 microsteps a mm.
  std::map<std::string, std::int32_t> values;    ///< What get() gives, by parameter as asked for.
  std::string known_axis;                        ///< Empty: all of them.
  std::string refused_parameter;                 ///< set() of it fails.
  std::optional<std::string> stop_cause;         ///< Of stopped_by_other_after.
  std::optional<Error> stop_failure;             ///< Of stop() only.
  Warnings warnings;                             ///< Of set() and of waits.
  std::string closed_because;                    ///< Why the bus of all axes is not open.
  tmcl::FirmwareVersion runs_then{1110, 1, 42};  ///< After an upload.

  // What happened.
  std::vector<std::string> calls;
  std::string said;  ///< The position, distance or velocity of the last call.

  Result<ScanResult> scan(ScanRange, const Progress& progress) override {
    if (failure) return tl::unexpected(*failure);
    if (progress) progress("bench", 16, 255);
    return found;
  }
  Result<std::vector<ModuleRow>> modules() override {
    if (failure) return tl::unexpected(*failure);
    return found.modules;
  }
  Result<std::vector<AxisRow>> axes() override {
    if (failure) return tl::unexpected(*failure);
    if (!closed_because.empty()) {
      return std::vector<AxisRow>{{{"x", "bench", 1, 0, {}, "unknown", {}}, closed_because},
                                  {{"y", "bench", 1, 1, {}, "unknown", {}}, closed_because}};
    }
    const auto unit = user ? std::optional(user->unit) : std::nullopt;
    return std::vector<AxisRow>{{{"x", "bench", 1, 0, "TMCM-1110", "ready", unit}}};
  }
  Result<std::vector<api::parameter::Parameter>> parameters(const std::string&) override {
    const std::string both = "read_write";
    return std::vector<api::parameter::Parameter>{
        {4, "max_velocity", both, true, 0, 2047, 1000, "internal", "speed", {}, {"v_max"}},
        {0, "target_position", both, false, -9, 9, 0, "microstep", "where to", {}, {"xtarget"}},
        {3, "actual_velocity", "read", false, -9, 9, 0, "internal", "speed now", {}, {}}};
  }
  static api::parameter::Held held(std::uint8_t number, const std::string& name, std::int32_t value,
                                   const std::optional<InUnit>& in_unit = {},
                                   const Warnings& warnings = {}) {
    api::parameter::Held held{{{name, number}, value, {}, {}}, warnings};
    if (in_unit) held.unit = in_unit->unit;
    if (in_unit) held.value_in_unit = in_unit->value;
    return held;
  }
  Result<api::parameter::Held> get(const std::string& axis, const std::string& parameter) override {
    if (failure) return tl::unexpected(*failure);
    const auto name = parse_parameter(common_parameters(), parameter);
    if (!name) return tl::unexpected(name.error());
    calls.push_back("get " + axis + ' ' + name->name);
    if (values.contains(parameter))
      return held(name->number, name->name, values[parameter], told_in_unit);
    return held(name->number, name->name, -1500);
  }
  using Target::set;
  Result<api::parameter::Held> set(const std::string& axis, const std::string& parameter,
                                   const Typed& typed) override {
    if (failure) return tl::unexpected(*failure);
    calls.push_back("set " + axis + ' ' + parameter + ' ' + typed.text);
    if (parameter == refused_parameter)
      return tl::unexpected(error_of(ExitCode::refused, "refused_by_module", "it refused"));
    const auto value = attempt(tmcl::parse_quantity(typed.text));
    if (!value) return tl::unexpected(value.error());
    return held(4, "max_velocity", static_cast<std::int32_t>(value->number), {}, warnings);
  }
  Result<AxisUnits> units(const std::string& axis) override {
    if (failure) return tl::unexpected(*failure);
    calls.push_back("units " + axis);
    if (axis != known_axis && !known_axis.empty())
      return tl::unexpected(usage_error("unknown_axis", "there is no axis '" + axis + "'"));
    return counts;
  }
  Result<api::axis::StartedMove> move_to(const std::string& axis, const Typed& position) override {
    return go(axis, position, 0);
  }
  Result<api::axis::StartedMove> move_by(const std::string& axis, const Typed& distance) override {
    return go(axis, distance, at());
  }
  Result<api::axis::Turning> rotate(const std::string& axis, const Typed& velocity,
                                    bool unattended) override {
    if (failure) return tl::unexpected(*failure);
    const auto value = counted(velocity, tmcl::axis_parameter::target_velocity);
    if (!value) return tl::unexpected(value.error());
    calls.push_back("rotate " + axis + ' ' + std::to_string(*value) +
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
  Result<void> stop(const std::string& axis) override {
    if (failure) return tl::unexpected(*failure);
    if (stop_failure) return tl::unexpected(*stop_failure);
    calls.push_back("stop " + axis);
    return {};
  }
  Result<std::vector<StoppedAxis>> stop_all() override {
    calls.push_back("stop_all");
    return stopped;
  }
  Result<AxisReading> state(const std::string&) override {
    if (failure) return tl::unexpected(*failure);
    AxisReading reading;
    reading.axis = "x";
    reading.position_microsteps = at();
    reading.target_microsteps = target_;
    const auto direction = target_ >= from_ ? 1 : -1;
    reading.moving = at() != target_ && !stopped_now();
    reading.velocity_internal = reading.moving ? 100 * direction : 0;
    reading.position_reached = at() == target_;
    reading.taken_at = host_.now();
    if (stopped_now()) reading.stop_cause = stop_cause;
    if (user) user->put_into(reading);
    if (tells_position_in_mm)
      UserReading{"mm", at() / 10'240.0, target_ / 10'240.0, 0.5}.put_into(reading);
    return reading;
  }
  Result<void> watch(const std::string& axis, tmcl::Duration interval,
                     const ReadingHandler& on_reading) override {
    while (true) {
      const auto reading = state(axis);
      if (!reading) return tl::unexpected(reading.error());
      if (!on_reading(&*reading)) return {};
      host_.sleep(interval);
    }
  }
  Result<Warnings> wait(const Wait& wait,
                        const std::function<void(const AxisReading&)>& on_reading) override {
    const auto begin = host_.now();
    while (true) {
      const auto reading = state(wait.axis);
      if (!reading) return tl::unexpected(reading.error());
      on_reading(*reading);
      if (host_.signal() != 0)
        return tl::unexpected(error_of(ExitCode::interrupted, "cancelled", "interrupted"));
      if (reading->position_microsteps == wait.goal.value) return warnings;
      if (stopped_now())
        return tl::unexpected(error_of(ExitCode::not_reached, "move_interrupted", "it stands"));
      if (wait.at_most && host_.now() - begin >= *wait.at_most)
        return tl::unexpected(error_of(ExitCode::not_reached, "deadline_passed", "it moves"));
      host_.sleep(wait.interval);
    }
  }
  Result<void> watch_axes(const std::vector<std::string>& axes, tmcl::Duration interval,
                          const AxesWatcher& watcher) override {
    calls.push_back("watch " + std::to_string(axes.size()));
    if (failure) return tl::unexpected(*failure);
    for (const auto& axis : axes) watcher.on_reading(axis, *state(axis));
    for (const auto& event : std::exchange(events, {})) watcher.on_event(event);
    if (losses-- > 0) return tl::unexpected(away());
    while (watcher.wanted()) {
      host_.sleep(interval);
      for (const auto& axis : axes) watcher.on_reading(axis, *state(axis));
    }
    return {};
  }
  Result<void> reopen() override {
    if (away_for-- > 0) return tl::unexpected(away());
    return {};
  }
  static Error away() {
    return error_of(ExitCode::not_sent, std::string(tmcl::client::error_name::lost),
                    "tmcld has gone");
  }
  std::vector<boost::json::object> events;  ///< Told once.
  int losses = 0;                           ///< So often tmcld goes away,
  int away_for = 0;                         ///< and it is asked for so often in vain.
  Result<RawAnswer> raw(const RawCommand& command) override {
    if (failure) return tl::unexpected(*failure);
    RawAnswer answer;
    answer.bus = "bench";
    answer.reply = {2, 1, tmcl::Status::ok, command.request.command, 1000};
    if (command.request.command == tmcl::Command::ROR) answer.warnings.emplace_back("it turns");
    return answer;
  }
  Result<boost::json::object> perform(const std::string& method, boost::json::object params,
                                      const NewsHandler& on_news) override {
    if (failure) return tl::unexpected(*failure);
    calls.push_back(method + ' ' + boost::json::serialize(params));
    if (on_news && !on_news({{"phase", "writing"}, {"done", 1}, {"of", 2}, {"step", 1}})) {
      return tl::unexpected(error_of(ExitCode::unknown, "download_broken", "it was cancelled"));
    }
    if (results.empty()) return result;
    result = results.front();
    results.pop_front();
    return result;
  }
  std::deque<boost::json::object> results;  ///< One after the other, before `result`.
  boost::json::object result;               ///< Of every other method.
  Result<void> hear_arrivals(const ModuleName&, const std::function<Result<void>()>& ask,
                             const ArrivalHandler& on_arrival) override {
    auto asked = ask();
    if (!asked) return asked;
    for (const auto& motors : arrivals) {
      host_.sleep(std::chrono::seconds(1));
      if (!on_arrival(&motors)) return {};
    }
    while (on_arrival(nullptr)) host_.sleep(std::chrono::seconds(1));
    return {};
  }
  std::vector<std::vector<std::uint8_t>> arrivals;  ///< One a second.
  Result<tmcl::FirmwareMatch> match_firmware(const ModuleName& module,
                                             const tmcl::firmware::Image& image) override {
    if (failure) return tl::unexpected(*failure);
    calls.push_back("match_firmware " + module.bus + ':' + std::to_string(module.address));
    return tmcl::FirmwareMatch{
        1110, false, {1110, 1, 1}, versions_in(image), version_for(image, 1110)};
  }
  Result<tmcl::FirmwareReport> upload_firmware(const ModuleName& module,
                                               const tmcl::firmware::Image& image,
                                               const tmcl::FirmwareOptions& options) override {
    auto match = match_firmware(module, image);
    if (!match) return tl::unexpected(match.error());
    calls.back() = options.force ? "upload_firmware by force" : "upload_firmware";
    for (const auto* step : {"erasing", "writing", "starting"})
      options.progress({step, image.bytes.size() / 2, image.bytes.size()});
    return tmcl::FirmwareReport{*match, runs_then, checksum(image)};
  }
  Result<boost::json::object> perform_watched(const std::string& method, boost::json::object params,
                                              const std::string* text,
                                              const Watcher& watcher) override {
    if (failure) return tl::unexpected(*failure);
    if (text != nullptr) run_text = *text;
    calls.push_back(method + ' ' + boost::json::serialize(params));
    if (method == "path.plan") {
      if (plan_failure) return tl::unexpected(*plan_failure);
      return plan;
    }
    for (const auto& one : news) watcher.on_news(one);
    for (int i = 0; i < 20; ++i) {
      host_.sleep(std::chrono::milliseconds(100));
      watcher.meanwhile();
    }
    if (run_failure) return tl::unexpected(*run_failure);
    return result;
  }
  std::string run_text;
  std::vector<boost::json::object> news{{{"phase", "running"}, {"passed_s", 0.5}}};
  std::optional<Error> run_failure;
  std::optional<Error> plan_failure;
  boost::json::object plan;
  void sleep(tmcl::Duration duration) override { host_.sleep(duration); }
  Result<void> see_through(bool tell, Output& output) override {
    if (tell && watches) output.err << "watching\n";
    return {};
  }
  bool watches = false;  ///< Axes that are on their way when a verb has ended.
  std::string options() const override { return " --direct can:can0"; }

 private:
  /// A number without a unit is what the module counts, although the axis has a unit.
  Result<std::int32_t> counted(const Typed& typed, std::uint8_t parameter) {
    said = typed.text + (typed.internal ? " --internal" : "");
    const auto quantity = attempt(tmcl::parse_quantity(typed.text));
    if (!quantity) return tl::unexpected(quantity.error());
    return attempt(to_parameter(*quantity, quantity->unit.empty() ? AxisUnits{"x"} : counts,
                                *find_parameter(counts.parameters(), parameter)));
  }
  Result<api::axis::StartedMove> go(const std::string& axis, const Typed& way, std::int32_t from) {
    if (failure) return tl::unexpected(*failure);
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
  std::int32_t from_ = 0;
  std::int32_t target_ = 0;
  tmcl::TimePoint began_{};
};

/// Runs one command line against the fake axis.
class Ctl {
 public:
  FakeHost host;
  FakeTarget target{host};
  Screen screen;  ///< Both streams'. A plain file, unless the test says otherwise.

  std::string out;
  std::string err;

  ExitCode run(const std::vector<std::string>& arguments) {
    std::ostringstream out_stream;
    std::ostringstream err_stream;
    Output output{out_stream, err_stream, screen, screen};
    const auto exit = tmclctl::run(arguments, output, host, target);
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

// move, rotate, stop.
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "arrival_wait.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// Modules are numbered from 1 upwards, so the first of them are told to stop before the rest has
// been looked for.
constexpr std::uint16_t stop_scan_step = 16;
constexpr std::uint16_t stop_scan_last = 255;
constexpr tmcl::Duration turning_interval = std::chrono::milliseconds(100);
constexpr int narrowest_bar = 10;
constexpr int widest_bar = 40;
// Of the progress line without its bar.
constexpr int words_width = 72;

tmcl::Duration seconds(double count) {
  return std::chrono::duration_cast<tmcl::Duration>(std::chrono::duration<double>(count));
}

double fraction_done(std::int64_t start, std::int64_t goal, std::int64_t position) {
  return start == goal ? 1.0
                       : static_cast<double>(position - start) / static_cast<double>(goal - start);
}

struct Stood {
  AxisReading at;
  Warnings warnings;
};

// "1.4 s left"; empty where that is unknown.
std::string time_left(const std::optional<double>& predicted_s, tmcl::Duration passed) {
  if (!predicted_s) return "";
  const auto passed_s = std::chrono::duration<double>(passed).count();
  return fmt::format("  {:.1f} s left", std::max(*predicted_s - passed_s, 0.0));
}

/// Where the axis stands at last. What it was not warned of when it set out is told.
Result<Stood> wait_for_arrival(const Journey& journey, const api::axis::StartedMove& move,
                               bool internal, Context& context) {
  ProgressLine line(context.output);
  std::optional<std::int32_t> start;
  AxisReading last;
  const auto arrived = follow(journey, context, [&](const AxisReading& reading) {
    last = reading;
    if (!line.visible()) return;
    if (!start) start = reading.position_microsteps;
    const auto done = std::clamp(
        fraction_done(*start, journey.goal.value, reading.position_microsteps), 0.0, 1.0);
    const int width = std::clamp(line.screen().width - words_width, narrowest_bar, widest_bar);
    line.show(fmt::format("{} {} {:3}%{}  {} of {}  velocity {}", journey.axis,
                          bar(done, width, line.screen().utf8), static_cast<int>(done * 100),
                          time_left(move.predicted_s, context.host.now() - journey.started_at),
                          position_text(reading, internal),
                          shown(journey.goal_in_unit, journey.goal.value),
                          velocity_text(reading, internal)));
  });
  if (!arrived) return tl::unexpected(arrived.error());
  if (*arrived != move.warnings) warn(*arrived, context.output);
  return Stood{last, *arrived};
}

Journey journey_of(const std::string& axis, const api::axis::StartedMove& move, bool internal,
                   const std::optional<double>& timeout_s, tmcl::TimePoint started_at) {
  Journey journey{axis, {move.target_microsteps}, started_at, follow_interval};
  if (timeout_s) journey.timeout = seconds(*timeout_s);
  if (!internal) journey.goal_in_unit = in_unit(move.target, move.unit);
  return journey;
}

}  // namespace

Result<ExitCode> run(const verb::Move& verb, Context& context) {
  if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
  const auto move = start_move(verb.axis, {verb.position, verb.internal}, verb.by, context);
  if (!move) return tl::unexpected(move.error());
  warn(move->warnings.value_or(Warnings()), context.output);
  const auto journey =
      journey_of(verb.axis, *move, verb.internal, verb.timeout_s, context.host.now());
  auto document = api::to_json(*move);
  document["axis"] = verb.axis;
  auto line =
      fmt::format("{} moves to {}{}\n", verb.axis, shown(journey.goal_in_unit, journey.goal.value),
                  move->predicted_s ? fmt::format(" in {:.2f} s", *move->predicted_s) : "");
  if (verb.wait) {
    const auto there = wait_for_arrival(journey, *move, verb.internal, context);
    if (!there) return tl::unexpected(there.error());
    document["position_microsteps"] = there->at.position_microsteps;
    document["position"] = api::write_value(there->at.position);
    document["reached"] = true;
    line = fmt::format("{} stands at {}\n", verb.axis, position_text(there->at, verb.internal));
  }
  if (context.output.json) {
    print_json(document, context.output);
  } else {
    context.output.out << line;
  }
  return ExitCode::done;
}

namespace {

Result<Stood> wait_for_axis(const std::string& axis, const verb::Wait& verb,
                            tmcl::TimePoint started_at, Context& context) {
  const auto now = state_of(axis, context);
  if (!now) return tl::unexpected(now.error());
  const api::axis::StartedMove move{now->target_microsteps, now->unit, now->target, {}, {}};
  return wait_for_arrival(journey_of(axis, move, verb.internal, verb.timeout_s, started_at), move,
                          verb.internal, context);
}

}  // namespace

Result<ExitCode> run(const verb::Wait& verb, Context& context) {
  const auto started_at = context.host.now();
  json::array axes;
  for (const auto& axis : verb.axes) {
    const auto stood = wait_for_axis(axis, verb, started_at, context);
    if (!stood) return tl::unexpected(stood.error());
    const auto& [at, warnings] = *stood;
    axes.push_back(json::object{{"axis", axis},
                                {"position_microsteps", at.position_microsteps},
                                {"unit", api::write_value(at.unit)},
                                {"position", api::write_value(at.position)},
                                {"warnings", json::array(warnings.begin(), warnings.end())}});
    if (!context.output.json) {
      context.output.out << fmt::format("{} stands at {}\n", axis,
                                        position_text(at, verb.internal));
    }
  }
  if (context.output.json) print_json({{"axes", std::move(axes)}}, context.output);
  return ExitCode::done;
}

namespace {

void print_turning(const verb::Rotate& verb, const api::axis::Turning& turning,
                   const std::string& how_to_stop, Output& output) {
  if (output.json) {
    return print_json({{"axis", verb.axis},
                       {"velocity_internal", turning.velocity_internal},
                       {"unit", api::write_value(turning.unit)},
                       {"velocity", api::write_value(turning.velocity)}},
                      output);
  }
  const auto speed =
      verb.internal ? std::nullopt : in_unit_a_second(turning.velocity, turning.unit);
  output.out << fmt::format("{} turns with velocity {}. {}", verb.axis,
                            shown(speed, turning.velocity_internal), how_to_stop)
             << std::endl;
}

/// Until a signal comes; or how it was seen when it had come to stand before.
Result<std::optional<AxisReading>> watch_turning(const verb::Rotate& verb, Context& context) {
  ProgressLine line(context.output);
  bool has_turned = false;
  std::optional<AxisReading> stands;
  const auto watched = watch(
      verb.axis, turning_interval,
      [&](const AxisReading* reading) {
        if (reading != nullptr) {
          if (has_turned && !reading->moving) stands = *reading;
          has_turned = has_turned || reading->moving;
          line.show(fmt::format("{} at {}  velocity {}", verb.axis,
                                position_text(*reading, verb.internal),
                                velocity_text(*reading, verb.internal)));
        }
        return context.host.signal() == 0 && !stands;
      },
      context);
  if (!watched && context.host.signal() == 0) return tl::unexpected(watched.error());
  return stands;
}

Error stopped_elsewhere(const std::string& axis, const AxisReading& stands) {
  Error failure{"move_interrupted", ErrorKind::ended_early, tmcl::Outcome::done,
                axis + " does not turn any more: it was not stopped here",
                advice_on_stop(axis, stands.stop_cause.value_or(""))};
  if (!stands.stop_cause) return failure;
  failure.message += "; cause: " + *stands.stop_cause;
  failure.subject["stop_cause"] = *stands.stop_cause;
  return failure;
}

/// `why` it is not known that it stands.
Error may_still_turn(const std::string& axis, Error why, const Context& context) {
  // That it turns is known; what its stop has come to is not.
  why.kind = ErrorKind::failed;
  why.outcome = tmcl::Outcome::done;
  why.message = fmt::format("{} may still turn: {}", axis, why.message);
  why.hint = how_to_stop(axis, context);
  return why;
}

Result<ExitCode> attend(const verb::Rotate& verb, Context& context) {
  const auto stands = watch_turning(verb, context);
  context.host.take_signal();
  if (stands && *stands) return tl::unexpected(stopped_elsewhere(verb.axis, **stands));
  const auto stopped = context.call(api::axis::Stop{verb.axis});
  if (!stopped) return tl::unexpected(may_still_turn(verb.axis, stopped.error(), context));
  if (!stands) return tl::unexpected(stands.error());
  if (!context.output.json) context.output.out << verb.axis << " stops\n";
  return ExitCode::done;
}

}  // namespace

Result<ExitCode> run(const verb::Rotate& verb, Context& context) {
  const Typed velocity{verb.velocity, verb.internal};
  const auto turning = context.call(api::axis::Rotate{
      verb.axis, velocity.counted(), velocity.amount(), verb.unattended, move_deadline_ms});
  if (!turning) return tl::unexpected(turning.error());
  warn(turning->warnings.value_or(Warnings()), context.output);
  const bool attends = !verb.unattended && turning->velocity_internal != 0;
  print_turning(verb, *turning, attends ? "Ctrl-C stops it" : how_to_stop(verb.axis, context),
                context.output);
  if (!attends) return ExitCode::done;
  return attend(verb, context);
}

namespace {

bool is_all(std::string word) {
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word == "all";
}

Error stopped_nothing(Error failure) {
  auto& hint = failure.hint;
  if (!hint.empty()) hint[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(hint[0])));
  hint = std::string(everything_moves) + hint;
  return failure;
}

struct StoppedAxis {
  std::string axis;
  std::optional<double> milliseconds;
  std::optional<Error> error;
};

void stop_motors(const ModuleRow& module, std::vector<StoppedAxis>& stopped, Context& context) {
  for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
    StoppedAxis row{axis_name({tmcl::ModuleAddress{module.address}, motor}), {}, {}};
    const auto before = context.host.now();
    const auto result = context.call(api::axis::Stop{row.axis});
    const std::chrono::duration<double, std::milli> took = context.host.now() - before;
    if (result) {
      row.milliseconds = took.count();
    } else {
      row.error = result.error();
    }
    stopped.push_back(std::move(row));
  }
}

Result<std::vector<StoppedAxis>> stop_found(Context& context) {
  std::vector<StoppedAxis> stopped;
  for (std::uint16_t first = 1; first <= stop_scan_last; first += stop_scan_step) {
    const auto last = static_cast<std::uint16_t>(first + stop_scan_step - 1);
    const auto found = scan({first, std::min(last, stop_scan_last)}, {}, context);
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().error);
    for (const auto& module : found->modules) stop_motors(module, stopped, context);
  }
  return stopped;
}

Result<std::vector<StoppedAxis>> stop_everything(Context& context) {
  if (context.gateway.axes_from == AxesFrom::scan) return stop_found(context);
  return context.call(api::system::StopAll{}).map([](const api::system::StoppedAxes& result) {
    std::vector<StoppedAxis> rows;
    for (const auto& [axis, milliseconds] : result.stopped)
      rows.push_back({axis, milliseconds, {}});
    for (const auto& [axis, error] : result.failed)
      rows.push_back({axis, {}, tmcl::client::error_from_json(error)});
    return rows;
  });
}

ExitCode show_stopped(const std::vector<StoppedAxis>& axes, Output& output) {
  json::array stopped;
  json::array failed;
  auto exit = ExitCode::done;
  for (const auto& row : axes) {
    if (row.error) {
      failed.push_back(json::object{{"axis", row.axis}, {"error", error_document(*row.error)}});
      exit = std::max(exit, exit_code_of(*row.error));
      if (!output.json)
        output.err << "tmclctl: " << row.axis << " NOT stopped: " << error_text(*row.error) << '\n';
    } else {
      stopped.push_back(
          json::object{{"axis", row.axis}, {"milliseconds", row.milliseconds.value_or(0)}});
      if (!output.json) {
        output.out << fmt::format("{} stopped after {:.1f} ms\n", row.axis,
                                  row.milliseconds.value_or(0));
      }
    }
  }
  if (output.json)
    print_json({{"stopped", std::move(stopped)}, {"failed", std::move(failed)}}, output);
  return exit;
}

}  // namespace

Result<ExitCode> run(const verb::Stop& verb, Context& context) {
  const auto stop_all = [&] {
    return stop_everything(context).map(
        [&](const std::vector<StoppedAxis>& axes) { return show_stopped(axes, context.output); });
  };
  if (verb.all) return stop_all();
  const auto stopped = context.call(api::axis::Stop{verb.axis});
  const bool names_none = !stopped && exit_code_of(stopped.error()) == ExitCode::usage;
  // An axis may have that name.
  if (names_none && is_all(verb.axis)) return stop_all();
  if (names_none) return tl::unexpected(stopped_nothing(stopped.error()));
  if (!stopped) return tl::unexpected(stopped.error());
  if (context.output.json) {
    print_json({{"axis", verb.axis}, {"stopped", true}}, context.output);
  } else {
    context.output.out << verb.axis << " stops\n";
  }
  return ExitCode::done;
}

}  // namespace tmclctl

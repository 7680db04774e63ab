// move, wait.
#include <algorithm>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

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

Result<Stood> wait_for_axis(const std::string& axis, const verb::Wait& verb,
                            tmcl::TimePoint started_at, Context& context) {
  const auto now = state_of(axis, context);
  if (!now) return tl::unexpected(now.error());
  const api::axis::StartedMove move{now->target_microsteps, now->unit, now->target, {}, {}};
  return wait_for_arrival(journey_of(axis, move, verb.internal, verb.timeout_s, started_at), move,
                          verb.internal, context);
}

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

constexpr const char* move_help = R"(
Comes back as soon as the module has accepted the move; with --wait when the axis stands at its
target. While it waits it draws a progress line, if standard error is a terminal. Ctrl-C ends the
waiting and NOT the move: it tells how to stop the axis and exits with 130.

On an axis with a unit, POSITION needs one: 10mm, or 10microsteps. Bare numbers other than 0 count
microsteps only on axes without a unit, and with --internal.

  tmclctl move x 10mm
  tmclctl move x 51200 --internal
  tmclctl move x 1.5rev
  tmclctl move x -1000 --by --wait
  tmclctl move x 0.1mm --by --wait               again and again: what is rounded does not add up
  tmclctl move x 0 --wait --timeout 30
)";

constexpr const char* wait_help = R"(
Comes back when all of them stand at their targets, whichever client sent them there; one that swings about its
target does not stand there, and a warning says why it swings. An axis that is stopped
short of its target ends it (exit code 5). Ctrl-C ends the waiting and NOT the moves.

  tmclctl move x 10mm; tmclctl move y 0; tmclctl wait x y
  tmclctl wait x --timeout 30 && echo there
)";

}  // namespace

void add_move(Grammar& grammar) {
  auto move = grammar.verb<verb::Move>("move", access::acts, "Move to a position, or by a distance",
                                       move_help, run);
  move.axis(move->axis);
  move.word("POSITION", "Where to go, with a unit; may be negative", text(move->position));
  move.flag("--by", "POSITION is the distance from where the axis is now", move->by);
  move.flag("--wait", "Wait until the axis stands at its target", move->wait);
  move.option("--timeout", "SECONDS", "With --wait: give up after so long; the axis goes on",
              number(move->timeout_s, shortest_time_s, longest_time_s));
  move.internal(move->internal);
  move.object([](const verb::Move& said, bool) {
    return said.timeout_s && !said.wait ? "--timeout says how long to wait, and that needs --wait"
                                        : "";
  });
  auto wait = grammar.verb<verb::Wait>("wait", access::reads,
                                       "Wait until axes stand at their targets", wait_help, run);
  wait.words("AXIS", axis_meaning, texts(wait->axes));
  wait.option("--timeout", "SECONDS", "Give up after so long; the axes go on",
              number(wait->timeout_s, shortest_time_s, longest_time_s));
  wait.internal(wait->internal);
  wait.object([](const verb::Wait& said, bool) {
    return said.axes.empty() ? "name at least one AXIS" : "";
  });
}

}  // namespace tmclctl

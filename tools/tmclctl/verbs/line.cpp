// line.
#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "command_line/form.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/path.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

api::line::Move params_of(const verb::Line& verb) {
  api::line::Move params;
  auto& positions = params.positions.emplace();
  for (const auto& [axis, position] : verb.goals) {
    params.axes.push_back(axis);
    const bool is_bare = parse_number<std::int32_t>(position).has_value();
    positions.emplace_back(verb.internal && is_bare ? position + "microsteps" : position);
  }
  if (!verb.velocity.empty()) params.velocity = verb.velocity;
  if (!verb.acceleration.empty()) params.acceleration = verb.acceleration;
  params.time_s = verb.time_s;
  return params;
}

// Nothing for an axis without a unit.
std::optional<InUnit> goal_in_unit(const api::line::LineAxis& axis, bool internal) {
  return internal ? std::nullopt : in_unit(axis.target, axis.unit);
}

std::vector<Journey> journeys_of(const verb::Line& verb, const api::line::StartedLine& line,
                                 tmcl::TimePoint started_at) {
  std::vector<Journey> journeys;
  for (const auto& axis : line.axes) {
    Journey journey{axis.axis, {axis.target_microsteps},         started_at, follow_interval,
                    {},        goal_in_unit(axis, verb.internal)};
    if (verb.timeout_s) {
      journey.timeout = std::chrono::duration_cast<tmcl::Duration>(
          std::chrono::duration<double>(*verb.timeout_s));
    }
    journeys.push_back(std::move(journey));
  }
  return journeys;
}

Result<void> wait_for_all(const verb::Line& verb, const api::line::StartedLine& line,
                          tmcl::TimePoint started_at, Context& context) {
  const double predicted_s = line.predicted_s;
  ProgressLine progress(context.output);
  for (const auto& journey : journeys_of(verb, line, started_at)) {
    const auto arrived = follow(journey, context, [&](const AxisReading&) {
      const auto passed = std::chrono::duration<double>(context.host.now() - started_at).count();
      const double done = predicted_s > 0 ? std::clamp(passed / predicted_s, 0.0, 1.0) : 1;
      progress.show(fmt::format("{} {:3}%  {:.1f} s left",
                                bar(done, usual_bar_width, progress.screen().utf8),
                                static_cast<int>(done * 100), std::max(predicted_s - passed, 0.0)));
    });
    if (!arrived) return tl::unexpected(arrived.error());
  }
  return {};
}

// What would be shown as 0.00.
constexpr double nothing = 0.005;

std::string together(double milliseconds) {
  return milliseconds < nothing ? "at the same time"
                                : fmt::format("within {:.2f} ms of each other", milliseconds);
}

std::string on_line(double percent) {
  return percent < nothing
             ? "along the straight line"
             : fmt::format("at most {:.2f} % of the longest way off the straight line", percent);
}

void print(const api::line::StartedLine& line, const verb::Line& verb, std::ostream& out) {
  for (const auto& axis : line.axes)
    out << fmt::format("{} {} {}\n", axis.axis, verb.wait ? "stands at" : "moves to",
                       shown(goal_in_unit(axis, verb.internal), axis.target_microsteps));
  out << fmt::format("Foreseen: {:.2f} s; all arrive {} and move {}. They were started {}.\n",
                     line.predicted_s, together(1e3 * line.spread_s), on_line(100 * line.deviation),
                     line.one_command ? "by one command" : together(1e3 * line.skew_s));
}

Result<ExitCode> run(const verb::Line& verb, Context& context) {
  if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
  const auto line = context.call(params_of(verb));
  if (!line) return tl::unexpected(line.error());
  const auto started_at = context.host.now();
  warn(line->warnings.value_or(Warnings()), context.output);
  if (verb.wait) {
    if (const auto arrived = wait_for_all(verb, *line, started_at, context); !arrived)
      return tl::unexpected(arrived.error());
  }
  if (context.output.json) {
    print_json(api::to_json(*line), context.output);
  } else {
    print(*line, verb, context.output.out);
  }
  return ExitCode::done;
}

constexpr double longest_line_s = 86'400;

Reading read_goal(const std::string& text, std::vector<verb::Line::Goal>& goals) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    return tl::unexpected("'" + text + "' is no AXIS=POSITION");
  goals.push_back({text.substr(0, equals), text.substr(equals + 1)});
  return {};
}

constexpr const char* line_help = R"(
The axes start together and arrive together: each gets the part of speed and acceleration that its
way is of the longest. Their own settings are the limits, and are set back at the end; --velocity and
--acceleration are limits of each axis, too. If one cannot take part, none moves; if one is stopped or
does not go as planned, all are stopped. Several motors of one module start with one command. With
--direct it stays until all axes stand and have their settings back; Ctrl-C stops them.
Ramp generators can be neither shaped for loads that swing nor given a jerk: a line with those is a path of one
leg, such as 'G1 X10 Y2.5 F1200' in a file for 'tmclctl path run --shape' or '--jerk'.

  tmclctl line x=51200microsteps y=-1.5rev --wait
  tmclctl line x=10mm y=2.5mm z=0
  tmclctl line x=10mm y=2.5mm --velocity 5mm/s
  tmclctl line x=10mm y=2.5mm --time 4
)";

}  // namespace

void add_line(Grammar& grammar) {
  auto line = grammar.verb<verb::Line>(
      "line", access::acts, "Move several axes together along a straight line", line_help, run);
  line.words("AXIS=POSITION", "Where each of them is to go, with a unit",
             [&goals = line->goals](const std::string& text) { return read_goal(text, goals); });
  line.option("--velocity", "VELOCITY", "What no axis exceeds, such as 20mm/s or 50000pps",
              text(line->velocity));
  line.option("--acceleration", "ACCELERATION",
              "What no axis exceeds, such as 100mm/s^2 or 200000pps/s", text(line->acceleration));
  line.option("--time", "SECONDS", "Take so long; without it, as short as possible",
              number(line->time_s, shortest_time_s, longest_line_s));
  line.flag("--wait", "Wait until all of them stand at their targets", line->wait);
  line.option("--timeout", "SECONDS", "With --wait: give up after so long; the axes go on",
              number(line->timeout_s, shortest_time_s, longest_time_s));
  line.internal(line->internal);
  line.object([](const verb::Line& said, bool) {
    if (said.goals.empty()) return "name at least one AXIS=POSITION";
    return said.timeout_s && !said.wait ? "--timeout says how long to wait, and that needs --wait"
                                        : "";
  });
}

}  // namespace tmclctl

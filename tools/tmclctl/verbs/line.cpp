// line.
#include <fmt/format.h>

#include "arrival_wait.hpp"
#include "options/form.hpp"
#include "print.hpp"
#include "progress_line.hpp"
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

}  // namespace

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

}  // namespace tmclctl

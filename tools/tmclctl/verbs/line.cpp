// line.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "following.hpp"
#include "json_read.hpp"
#include "options/form.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

json::object params_of(const verb::Line& verb) {
  json::array axes;
  json::array positions;
  for (const auto& [axis, position] : verb.goals) {
    axes.emplace_back(axis);
    const bool is_bare = parse_number<std::int32_t>(position).has_value();
    positions.emplace_back(verb.internal && is_bare ? position + "microsteps" : position);
  }
  json::object params{{"axes", std::move(axes)}, {"positions", std::move(positions)}};
  if (!verb.velocity.empty()) params["velocity"] = verb.velocity;
  if (!verb.acceleration.empty()) params["acceleration"] = verb.acceleration;
  if (verb.time_s) params["time_s"] = *verb.time_s;
  return params;
}

// Nothing for an axis without a unit.
std::optional<InUnit> goal_in_unit(const json::object& row, bool internal) {
  const auto target = number_at(row, "target");
  if (!target || internal) return std::nullopt;
  return InUnit{*target, text_at(row, "unit")};
}

std::vector<Journey> journeys_of(const verb::Line& verb, const json::object& line,
                                 tmcl::TimePoint started_at) {
  std::vector<Journey> journeys;
  for (const auto& value : array_at(line, "axes")) {
    const auto& row = value.as_object();
    Journey journey{text_at(row, "axis"),
                    {integer_at<std::int32_t>(row, "target_microsteps")},
                    started_at,
                    follow_interval,
                    {},
                    goal_in_unit(row, verb.internal)};
    if (verb.timeout_s) {
      journey.timeout = std::chrono::duration_cast<tmcl::Duration>(
          std::chrono::duration<double>(*verb.timeout_s));
    }
    journeys.push_back(std::move(journey));
  }
  return journeys;
}

Result<void> wait_for_all(const verb::Line& verb, const json::object& line,
                          tmcl::TimePoint started_at, Context& context) {
  const double predicted_s = number_at(line, "predicted_s").value_or(0);
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

void print(const json::object& line, const verb::Line& verb, std::ostream& out) {
  for (const auto& value : array_at(line, "axes")) {
    const auto& row = value.as_object();
    out << fmt::format("{} {} {}\n", text_at(row, "axis"), verb.wait ? "stands at" : "moves to",
                       shown(goal_in_unit(row, verb.internal),
                             integer_at<std::int32_t>(row, "target_microsteps")));
  }
  const auto milliseconds = [&](const char* key) { return 1e3 * number_at(line, key).value_or(0); };
  out << fmt::format(
      "Foreseen: {:.2f} s; all arrive {} and move {}. They were started {}.\n",
      number_at(line, "predicted_s").value_or(0), together(milliseconds("spread_s")),
      on_line(100 * number_at(line, "deviation").value_or(0)),
      flag_at(line, "one_command") ? "by one command" : together(milliseconds("skew_s")));
}

}  // namespace

VerbResult run(const verb::Line& verb, Context& context) {
  if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
  const auto line = context.target.perform("line.move", params_of(verb), {});
  if (!line) return tl::unexpected(line.error());
  const auto started_at = context.host.now();
  warn(texts_at(*line, "warnings"), context.output);
  if (verb.wait) {
    if (const auto arrived = wait_for_all(verb, *line, started_at, context); !arrived)
      return tl::unexpected(arrived.error());
  }
  if (context.output.json) {
    print_json(*line, context.output);
  } else {
    print(*line, verb, context.output.out);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

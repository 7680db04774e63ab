// line.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "asked.hpp"
#include "following.hpp"
#include "json_read.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr tmcl::Duration follow_interval = std::chrono::milliseconds(20);

Attempt<std::vector<AxisUnits>> units_of(const verb::Line& verb, Target& target) {
  std::vector<AxisUnits> all;
  for (const auto& goal : verb.goals) {
    auto units = target.units(goal.axis);
    if (!units) return tl::unexpected(units.error());
    // A limit holds in both directions.
    if (units->scale) units->scale->reverse = false;
    all.push_back(std::move(*units));
  }
  return all;
}

/// The two parameters that say the same.
struct LimitNames {
  const char* in_unit;
  const char* plain;
};

/// One number for all axes: in microsteps if it is the same for all of them, else in the unit that
/// they share.
template <class Value>
Attempt<void> put_limit(json::object& params, LimitNames names, const Quantity& said,
                        const std::vector<AxisUnits>& axes,
                        Attempt<Value> (*convert)(const Quantity&, const AxisUnits&)) {
  std::vector<double> values;
  for (const auto& units : axes) {
    const auto value = convert(said, units);
    if (!value) return tl::unexpected(value.error());
    if (!(value->value > 0)) {
      return tl::unexpected(
          usage_failure("bad_value", fmt::format("'{}' must be above 0", to_string(said))));
    }
    values.push_back(value->value);
  }
  const auto& first = axes.front();
  if (std::ranges::count(values, values.front()) == std::ssize(values)) {
    params[names.plain] = values.front();
    return {};
  }
  const bool same_unit = std::ranges::all_of(axes, [&](const AxisUnits& units) {
    return units.scale && !units.scale->unit.empty() && units.scale->unit == first.scale->unit;
  });
  if (!same_unit) {
    return tl::unexpected(usage_failure(
        "wrong_unit",
        fmt::format("'{}' is not the same for all of these axes, and they have no unit in common",
                    to_string(said)),
        "Give it in pps or pps/s"));
  }
  params[names.in_unit] = tmcl::to_user(Value{values.front()}, *first.scale).value;
  return {};
}

Attempt<void> put_limits(json::object& params, const verb::Line& verb, Target& target) {
  if (verb.time_s) params["time_s"] = *verb.time_s;
  if (!verb.velocity && !verb.acceleration) return {};
  const auto units = units_of(verb, target);
  if (!units) return tl::unexpected(units.error());
  Attempt<void> put;
  if (verb.velocity)
    put = put_limit(params, {"velocity", "velocity_pps"}, *verb.velocity, *units, to_pps);
  if (put && verb.acceleration) {
    put = put_limit(params, {"acceleration", "acceleration_pps2"}, *verb.acceleration, *units,
                    to_pps2);
  }
  return put;
}

Attempt<json::object> asked_line(const verb::Line& verb, Target& target) {
  json::array axes;
  json::array positions;
  for (const auto& [axis, position] : verb.goals) {
    const auto length = asked_position(position, axis, target);
    if (!length) return tl::unexpected(length.error());
    axes.emplace_back(axis);
    positions.emplace_back(length->microsteps.value);
  }
  json::object params{{"axes", std::move(axes)}, {"positions_microsteps", std::move(positions)}};
  return put_limits(params, verb, target).map([&] { return std::move(params); });
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

Attempt<void> wait_for_all(const verb::Line& verb, const json::object& line,
                           tmcl::TimePoint started_at, Room& room) {
  const double predicted_s = number_at(line, "predicted_s").value_or(0);
  ProgressLine progress(room.output);
  for (const auto& journey : journeys_of(verb, line, started_at)) {
    const auto arrived = follow(journey, room, [&](const AxisReading&) {
      const auto passed = std::chrono::duration<double>(room.patience.now() - started_at).count();
      const double done = predicted_s > 0 ? std::clamp(passed / predicted_s, 0.0, 1.0) : 1;
      constexpr int bar_width = 30;
      progress.show(fmt::format("{} {:3}%  {:.1f} s left",
                                bar(done, bar_width, progress.screen().utf8),
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

VerbResult run(const verb::Line& verb, Room& room) {
  if (auto interrupted = interrupted_before_move(room)) return tl::unexpected(*interrupted);
  auto params = asked_line(verb, room.target);
  if (!params) return tl::unexpected(params.error());
  const auto line = room.target.perform("line.move", std::move(*params), {});
  if (!line) return tl::unexpected(line.error());
  const auto started_at = room.patience.now();
  if (verb.wait) {
    if (const auto arrived = wait_for_all(verb, *line, started_at, room); !arrived)
      return tl::unexpected(arrived.error());
  }
  if (room.output.json) {
    print_json(*line, room.output);
  } else {
    print(*line, verb, room.output.out);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

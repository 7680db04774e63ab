// path run.
#include <algorithm>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "path/drive.hpp"
#include "path/path_report.hpp"
#include "path/run_axes.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;
using path::RunAxis;

// How far off its plan an axis may be seen, in tolerances.
constexpr double deviation_in_tolerances = 20;
// What part of the tolerance legs that are passed at an even speed may use up.
constexpr double even_part = 0.1;

double milliseconds(tmcl::Duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

path::RunWish wish_of(const verb::RunPath& verb) {
  return {verb.by_position ? plan::StreamMode::position : plan::StreamMode::velocity,
          verb.tolerance,
          verb.velocity,
          verb.acceleration,
          verb.feed,
          verb.per_turn};
}

std::vector<path::AxisChoice> choices_of(const std::vector<std::string>& words) {
  std::vector<path::AxisChoice> choices;
  for (const auto& word : words) {
    const auto equals = word.find('=');
    choices.push_back({word.substr(0, equals), word.substr(equals + 1)});
  }
  return choices;
}

std::vector<std::string> names_of(const std::vector<RunAxis>& axes) {
  std::vector<std::string> names;
  for (const auto& axis : axes) names.push_back(axis.name);
  return names;
}

Attempt<void> go_to_start(const plan::Course& course, const std::vector<RunAxis>& axes,
                          Room& room) {
  std::vector<tmcl::Microsteps> positions;
  const auto start = course.at(0).position;
  for (std::size_t i = 0; i < axes.size(); ++i)
    positions.push_back(path::microsteps(axes[i], start[i]));
  return path::go_to(names_of(axes), positions, "on the way to the start", room);
}

double per_second(double count, const plan::StreamReport& report) {
  return report.passed_s > 0 ? count / report.passed_s : 0;
}

json::object to_json(const plan::StreamReport& report, const std::vector<RunAxis>& axes) {
  json::array tracking;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    tracking.push_back(json::object{{"axis", axes[i].name},
                                    {"largest", report.axes[i].largest},
                                    {"rms", report.axes[i].rms()},
                                    {"readings", report.axes[i].readings}});
  }
  return {{"tracking_error", std::move(tracking)},
          {"passed_s", report.passed_s},
          {"updates", report.updates},
          {"period_ms", milliseconds(report.period)},
          {"worst_delay_ms", milliseconds(report.worst_delay)},
          {"commands", report.commands},
          {"commands_per_s", per_second(static_cast<double>(report.commands), report)},
          {"bus_load", per_second(report.busy_s, report)},
          {"round_trip_us", 1e3 * milliseconds(report.round_trip)}};
}

void print(const plan::StreamReport& report, const std::vector<RunAxis>& axes, bool by_position,
           Output& output) {
  Table table({"AXIS", "LARGEST ERROR", "RMS", "READINGS"});
  for (std::size_t i = 0; i < axes.size(); ++i) {
    table.add({axes[i].name, fmt::format("{:.4f}", report.axes[i].largest),
               fmt::format("{:.4f}", report.axes[i].rms()),
               fmt::format("{}", report.axes[i].readings)});
  }
  table.print(output.out);
  output.out << fmt::format("{} {} in {:.3f} s, {} {:.1f} ms, at most {:.1f} ms late\n",
                            report.updates, by_position ? "legs" : "updates", report.passed_s,
                            by_position ? "the shortest takes" : "one every",
                            milliseconds(report.period), milliseconds(report.worst_delay));
  output.out << fmt::format(
      "{:.0f} commands a second, {:.0f} us each: {:.0f} % of what the bus has\n",
      per_second(static_cast<double>(report.commands), report),
      1e3 * milliseconds(report.round_trip), 100 * per_second(report.busy_s, report));
}

VerbResult pass(const verb::RunPath& verb, const plan::Course& course,
                const std::vector<RunAxis>& axes, Room& room) {
  if (const auto there = go_to_start(course, axes, room); !there)
    return tl::unexpected(there.error());
  room.patience.catch_pauses();
  std::vector<plan::StreamAxis> streamed;
  for (const auto& axis : axes) streamed.push_back(axis.stream);
  plan::PathStream stream(
      course, std::move(streamed),
      {wish_of(verb).mode, verb.deviation.value_or(deviation_in_tolerances * verb.tolerance),
       verb.period, even_part * verb.tolerance});
  const auto names = names_of(axes);
  const int signal = path::drive(stream, names, course.duration(), room);
  const auto& report = stream.report();
  for (const auto& remark : report.remarks)
    room.output.err << "tmclctl: warning: " << path::with_names(remark, names) << '\n';
  if (report.fault) {
    auto failure = path::failure_from(*report.fault, names, signal);
    failure.details["run"] = to_json(report, axes);
    return tl::unexpected(failure);
  }
  if (room.output.json) {
    print_json(to_json(report, axes), room.output);
  } else {
    print(report, axes, verb.by_position, room.output);
  }
  return ExitCode::done;
}

}  // namespace

VerbResult run(const verb::RunPath& verb, Room& room) {
  const auto source = path::read_source(verb.file, verb.tolerance, room.output);
  if (!source) return tl::unexpected(source.error());
  const auto wish = wish_of(verb);
  const auto axes = path::read_axes(*source, choices_of(verb.axes), wish, room.target);
  if (!axes) return tl::unexpected(axes.error());
  const auto course = path::course_of(*source, path::limits_of(*axes, wish), verb.tolerance,
                                      verb.feed.value_or(std::numeric_limits<double>::infinity()));
  if (!course) return tl::unexpected(course.error());
  if (const auto reach = path::check_reach(*course, *axes); !reach)
    return tl::unexpected(reach.error());
  if (const auto drawn = path::draw(verb.svg, *source, *course); !drawn)
    return tl::unexpected(drawn.error());
  if (!verb.dry_run) return pass(verb, *course, *axes, room);
  if (room.output.json) {
    print_json(path::to_json(*source, *course), room.output);
  } else {
    path::print(*source, *course, room.output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

// path run.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "following.hpp"
#include "json_read.hpp"
#include "path/drive.hpp"
#include "path/path_report.hpp"
#include "path/run_axes.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;

plan::PathRequest request_of(const verb::RunPath& verb) {
  return {verb.by_position ? plan::StreamMode::position : plan::StreamMode::velocity,
          verb.tolerance,
          verb.velocity,
          verb.acceleration,
          verb.feed,
          verb.per_turn,
          verb.deviation,
          verb.period};
}

std::vector<plan::PathChoice> choices_of(const std::vector<std::string>& words) {
  std::vector<plan::PathChoice> choices;
  for (const auto& word : words) {
    const auto equals = word.find('=');
    choices.push_back({word.substr(0, equals), word.substr(equals + 1)});
  }
  return choices;
}

Attempt<void> go_to_start(const plan::Course& course, const std::vector<plan::PathAxis>& axes,
                          Context& context) {
  std::vector<tmcl::Microsteps> positions;
  const auto start = course.at(0).position;
  for (std::size_t i = 0; i < axes.size(); ++i)
    positions.push_back(plan::microsteps(axes[i], start[i]));
  return path::go_to(path::names_of(axes), positions, "on the way to the start", context);
}

struct Passed {
  Attempt<json::object> report;
  int signal = 0;  ///< That ended it; 0 if none did.
};

json::object params_of(const path::Source& source, const plan::PathRequest& request,
                       const std::vector<plan::PathAxis>& axes) {
  json::array names;
  json::array of_file;
  for (const auto& axis : axes) {
    names.emplace_back(axis.choice.axis);
    of_file.emplace_back(axis.choice.of_file);
  }
  json::object params{
      {"axes", std::move(names)},
      {"file_axes", std::move(of_file)},
      {"format", name_of(source.format)},
      {"mode", request.mode == plan::StreamMode::position ? "position" : "velocity"},
      {"tolerance", request.tolerance},
      {"period_ms", std::chrono::duration_cast<std::chrono::milliseconds>(request.period).count()}};
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) params[name] = *value;
  };
  add("velocity", request.velocity);
  add("acceleration", request.acceleration);
  add("feed", request.feed);
  add("per_turn", request.per_turn);
  add("deviation", request.deviation);
  return params;
}

Passed pass(const path::Source& source, const plan::PathRequest& request,
            const std::vector<plan::PathAxis>& axes, Context& context) {
  ProgressLine progress(context.output);
  int signal = 0;
  PathWatcher watcher;
  watcher.on_progress = [&](const PathProgress& now) { path::show(now, progress); };
  watcher.will = [&] {
    if (const int caught = context.host.take_signal(); caught != 0) signal = caught;
    if (signal != 0) return PathWill::stop;
    return context.host.pause_asked() ? PathWill::pause : PathWill::go_on;
  };
  auto report = context.target.pass_path(params_of(source, request, axes), source.text, watcher);
  // What stopped it before its end has moved the axes, or not.
  if (!report && report.error().details.contains("run")) {
    const bool moved = report.error().outcome == tmcl::Outcome::done;
    report.error().exit = moved ? ExitCode::not_reached : ExitCode::refused;
    report.error().outcome.reset();
  }
  return {std::move(report), signal};
}

// ---- how it went ----

void print(const json::object& report, bool by_position, Output& output) {
  const auto number = [&](const char* key) { return number_at(report, key).value_or(0); };
  Table table({"AXIS", "LARGEST ERROR", "RMS", "READINGS"});
  for (const auto& value : array_at(report, "tracking_error")) {
    const auto& row = value.as_object();
    table.add({text_at(row, "axis"), fmt::format("{:.4f}", number_at(row, "largest").value_or(0)),
               fmt::format("{:.4f}", number_at(row, "rms").value_or(0)),
               fmt::format("{:.0f}", number_at(row, "readings").value_or(0))});
  }
  table.print(output.out);
  output.out << fmt::format("{:.0f} {} in {:.3f} s, {} {:.1f} ms, at most {:.1f} ms late\n",
                            number("updates"), by_position ? "legs" : "updates", number("passed_s"),
                            by_position ? "the shortest takes" : "one every", number("period_ms"),
                            number("worst_delay_ms"));
  output.out << fmt::format(
      "{:.0f} commands a second, {:.0f} us each: {:.0f} % of what the bus has\n",
      number("commands_per_s"), number("round_trip_us"), 100 * number("bus_load"));
}

void warn(const json::object& report, Output& output) {
  for (const auto& remark : array_at(report, "remarks"))
    output.err << "tmclctl: warning: " << std::string_view(remark.as_string()) << '\n';
}

VerbResult tell(Passed passed, bool by_position, Output& output) {
  if (passed.report) {
    warn(*passed.report, output);
    if (output.json) {
      print_json(*passed.report, output);
    } else {
      print(*passed.report, by_position, output);
    }
    return ExitCode::done;
  }
  auto failure = std::move(passed.report.error());
  warn(object_at(failure.details, "run"), output);
  if (passed.signal == 0) return tl::unexpected(std::move(failure));
  auto interrupted = interrupted_failure(passed.signal, "stopped before the end of the path", "");
  interrupted.details = std::move(failure.details);
  return tl::unexpected(std::move(interrupted));
}

}  // namespace

VerbResult run(const verb::RunPath& verb, Context& context) {
  auto source = path::read_source(verb.file, verb.tolerance, context.output);
  if (!source) return tl::unexpected(source.error());
  const auto request = request_of(verb);
  const auto axes = path::read_axes(*source, choices_of(verb.axes), request, context.target);
  if (!axes) return tl::unexpected(axes.error());
  if (const auto begun = path::begin_where_axes_stand(*source, *axes, request, context.output);
      !begun)
    return tl::unexpected(begun.error());
  const auto course = path::course_of(*source, limits_of(*axes, request), request);
  if (!course) return tl::unexpected(course.error());
  if (const auto objection = objection_to_reach(*course, *axes))
    return tl::unexpected(path::failure_from(*objection));
  if (const auto drawn = path::draw(verb.svg, *source, *course); !drawn)
    return tl::unexpected(drawn.error());
  if (verb.dry_run) {
    if (context.output.json) {
      print_json(path::to_json(*source, *course), context.output);
    } else {
      path::print(*source, *course, context.output);
    }
    return ExitCode::done;
  }
  if (const auto there = go_to_start(*course, *axes, context); !there)
    return tl::unexpected(there.error());
  context.host.catch_pauses();
  return tell(pass(*source, request, *axes, context), verb.by_position, context.output);
}

}  // namespace tmclctl

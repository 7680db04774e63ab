// path run.
#include <algorithm>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "following.hpp"
#include "json_read.hpp"
#include "options/form.hpp"
#include "path/path_source.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/path.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using tmcl::plan::StreamMode;

struct Passed {
  Result<json::object> report;
  int signal = 0;  ///< That ended it; 0 if none did.
};

json::object params_of(const verb::RunPath& verb, const std::string& text) {
  json::object params{{"format", name_of(tmcl::plan::format_of(verb.file, text))},
                      {"mode", name_of(verb.mode)},
                      {"tolerance", verb.tolerance},
                      {"period_ms", verb.period.count()}};
  if (!verb.axes.empty()) {
    json::array names, of_file;
    for (const auto& word : verb.axes) {
      const auto equals = word.find('=');
      of_file.emplace_back(word.substr(0, equals));
      names.emplace_back(word.substr(equals + 1));
    }
    params["axes"] = std::move(names);
    params["file_axes"] = std::move(of_file);
  }
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) params[name] = *value;
  };
  const auto add_quantity = [&](const char* name, const std::string& typed) {
    const auto in_units = parse_number<double>(typed);
    if (!typed.empty()) params[name] = in_units ? json::value(*in_units) : json::value(typed);
  };
  add_quantity("velocity", verb.velocity);
  add_quantity("acceleration", verb.acceleration);
  add_quantity("feed", verb.feed);
  add_quantity("corner_jump", verb.corner_jump);
  add("per_turn", verb.per_turn);
  add("deviation", verb.deviation);
  if (!verb.svg.empty()) params["points"] = tmcl::api::path::most_curve_points;
  return params;
}

/// What is said of it is what is run.
Result<json::object> plan_of(const verb::RunPath& verb, Context& context) {
  const auto text = path::text_of(verb.file, path::most_path_bytes);
  if (!text) return tl::unexpected(text.error());
  auto planned = context.target.perform_watched("path.plan", params_of(verb, *text), &*text, {});
  return std::move(planned).map_error([&](Error failure) {
    return path::explained(std::move(failure), verb.file, context.output);
  });
}

/// Tells the gateway what is to become of the path: a signal ends it, SIGTSTP lets it stand.
class Steering {
 public:
  Steering(json::value axes, Context& context) : axes_(std::move(axes)), context_(context) {}

  void look() {
    if (signal_ == 0) signal_ = context_.host.take_signal();
    const char* wish = context_.host.pause_asked() ? "path.pause" : "path.resume";
    if (signal_ != 0) wish = "path.stop";
    if (wish == told_ || told_ == "path.stop") return;
    // Refused while the path has not begun: then it is told again.
    if (context_.target.perform(wish, {{"axes", axes_}}, {})) told_ = wish;
  }
  int signal() const { return signal_; }

 private:
  json::value axes_;
  Context& context_;
  std::string_view told_ = "path.resume";
  int signal_ = 0;
};

void show(const json::object& news, ProgressLine& line) {
  if (!line.visible()) return;
  const double duration_s = number_at(news, "duration_s").value_or(0);
  const double passed_s = number_at(news, "passed_s").value_or(0);
  const double done = duration_s > 0 ? std::clamp(passed_s / duration_s, 0.0, 1.0) : 1;
  line.show(
      fmt::format("{} {:3}%  {:.1f} s left  {}", bar(done, usual_bar_width, line.screen().utf8),
                  static_cast<int>(done * 100), (1 - done) * duration_s, text_at(news, "phase")));
}

Passed pass(const json::object& plan, Context& context) {
  ProgressLine progress(context.output);
  Steering steering(array_at(plan, "axes"), context);
  auto report = context.target.perform_watched(
      "path.run", {{"plan", integer_at<std::int32_t>(plan, "plan")}, {"to_start", true}}, nullptr,
      {[&](const json::object& news) { show(news, progress); }, [&] { steering.look(); }});
  // What stopped it before its end has moved the axes, or not.
  if (!report && report.error().subject.contains("run")) {
    const bool moved = report.error().outcome != tmcl::Outcome::not_sent;
    report.error().kind = moved ? ErrorKind::ended_early : ErrorKind::not_now;
  }
  return {std::move(report), steering.signal()};
}

// ---- how it went ----

void print(const json::object& report, StreamMode mode, Output& output) {
  const bool by_position = mode == StreamMode::position;
  const auto number = [&](const char* key) { return number_at(report, key).value_or(0); };
  Table table({"AXIS", "LARGEST ERROR", "RMS", "READINGS"});
  for (const auto& value : array_at(report, "tracking_error")) {
    const auto& row = value.as_object();
    table.add({text_at(row, "axis"), fmt::format("{:.4f}", number_at(row, "largest").value_or(0)),
               fmt::format("{:.4f}", number_at(row, "rms").value_or(0)),
               fmt::format("{:.0f}", number_at(row, "readings").value_or(0))});
  }
  table.print(output.out);
  output.out << fmt::format("seen at most {:.4f} off the path and {:.1f} ms late on it\n",
                            number("off_path"), 1e3 * number("lag_s"));
  output.out << fmt::format("{:.0f} {} in {:.3f} s, {} {:.1f} ms, at most {:.1f} ms late\n",
                            number("updates"), by_position ? "legs" : "updates", number("passed_s"),
                            mode == StreamMode::velocity ? "one every" : "the shortest takes",
                            number("period_ms"), number("worst_delay_ms"));
  output.out << fmt::format(
      "{:.0f} commands a second, {:.0f} us each: {:.0f} % of what the bus has\n",
      number("commands_per_s"), number("round_trip_us"), 100 * number("bus_load"));
}

VerbResult tell(Passed passed, StreamMode mode, Output& output) {
  if (passed.report) {
    path::warn(*passed.report, output);
    if (output.json) {
      print_json(*passed.report, output);
    } else {
      print(*passed.report, mode, output);
    }
    return ExitCode::done;
  }
  auto failure = std::move(passed.report.error());
  path::warn(object_at(failure.subject, "run"), output);
  if (passed.signal == 0) return tl::unexpected(std::move(failure));
  return tl::unexpected(interrupted_error(passed.signal, "stopped before the end of the path", "",
                                          std::move(failure.subject)));
}

}  // namespace

VerbResult run(const verb::RunPath& verb, Context& context) {
  const auto plan = plan_of(verb, context);
  if (!plan) return tl::unexpected(plan.error());
  warn(texts_at(*plan, "warnings"), context.output);
  auto course = object_at(*plan, "course");
  if (!verb.svg.empty()) {
    const auto drawn = path::draw(verb.svg, verb.file, course, object_at(*plan, "curve"));
    if (!drawn) return tl::unexpected(drawn.error());
  }
  if (!verb.dry_run) {
    if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
    context.host.catch_pauses();
    return tell(pass(*plan, context), verb.mode, context.output);
  }
  if (context.output.json) {
    course["file"] = verb.file;
    print_json(course, context.output);
  } else {
    path::print(verb.file, course, context.output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

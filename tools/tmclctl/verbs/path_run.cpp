// path run.
#include <algorithm>

#include <fmt/format.h>

#include "arrival_wait.hpp"
#include "options/form.hpp"
#include "path/path_source.hpp"
#include "print.hpp"
#include "progress_line.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
using tmcl::plan::StreamMode;

struct PathEnd {
  Result<api::path::Passed> report;
  int signal = 0;  ///< That ended it; 0 if none did.
};

// Planning a long path takes a while.
constexpr auto longest_path_silence = std::chrono::seconds(120);

// A number alone is one in the units of the file.
std::optional<api::Amount> amount_of(const std::string& typed) {
  if (typed.empty()) return std::nullopt;
  const auto in_units = parse_number<double>(typed);
  return in_units ? api::Amount(*in_units) : api::Amount(typed);
}

api::path::Plan params_of(const verb::RunPath& verb, const std::string& text) {
  api::path::Plan params;
  params.format = name_of(tmcl::plan::format_of(verb.file, text));
  params.mode = name_of(verb.mode);
  params.tolerance = verb.tolerance;
  params.period_ms = static_cast<std::int32_t>(verb.period.count());
  for (const auto& word : verb.axes) {
    const auto equals = word.find('=');
    if (!params.axes) params.axes.emplace(), params.file_axes.emplace();
    params.file_axes->push_back(word.substr(0, equals));
    params.axes->push_back(word.substr(equals + 1));
  }
  params.velocity = amount_of(verb.velocity);
  params.acceleration = amount_of(verb.acceleration);
  params.feed = amount_of(verb.feed);
  params.corner_jump = amount_of(verb.corner_jump);
  params.per_turn = verb.per_turn;
  params.deviation = verb.deviation;
  if (!verb.svg.empty()) params.points = api::path::most_curve_points;
  return params;
}

/// What is said of it is what is run.
Result<api::path::Planned> plan_of(const verb::RunPath& verb, Context& context) {
  const auto text = path::text_of(verb.file, path::most_path_bytes);
  if (!text) return tl::unexpected(text.error());
  auto params = params_of(verb, *text);
  const tmcl::client::CallOptions options{longest_path_silence, {}};
  if (const auto staged = path::hand_over(*text, params, context, options); !staged)
    return tl::unexpected(staged.error());
  return context.call(params, options).map_error([&](Error failure) {
    return path::explained(std::move(failure), verb.file, context.output);
  });
}

/// Tells the gateway what is to become of the path: a signal ends it, SIGTSTP lets it stand.
class Steering {
 public:
  Steering(std::vector<std::string> axes, Context& context)
      : axes_(std::move(axes)), context_(context) {}

  void look() {
    if (signal_ == 0) signal_ = context_.host.take_signal();
    auto wish = context_.host.pause_asked() ? Wish::pause : Wish::resume;
    if (signal_ != 0) wish = Wish::stop;
    if (wish == told_ || told_ == Wish::stop) return;
    // Refused while the path has not begun: then it is told again.
    if (tell(wish)) told_ = wish;
  }
  int signal() const { return signal_; }

 private:
  enum class Wish : std::uint8_t { resume, pause, stop };
  bool tell(Wish wish) {
    switch (wish) {
      case Wish::pause: return context_.call(api::path::Pause{{axes_}}).has_value();
      case Wish::resume: return context_.call(api::path::Resume{{axes_}}).has_value();
      case Wish::stop: break;
    }
    return context_.call(api::path::Stop{{axes_}}).has_value();
  }

  std::vector<std::string> axes_;
  Context& context_;
  Wish told_ = Wish::resume;
  int signal_ = 0;
};

void show(const api::PathProgress& news, ProgressLine& line) {
  if (!line.visible()) return;
  const double done =
      news.duration_s > 0 ? std::clamp(news.passed_s / news.duration_s, 0.0, 1.0) : 1;
  line.show(fmt::format("{} {:3}%  {:.1f} s left  {}",
                        bar(done, usual_bar_width, line.screen().utf8),
                        static_cast<int>(done * 100), (1 - done) * news.duration_s, news.phase));
}

PathEnd pass(const api::path::Planned& plan, Context& context) {
  ProgressLine progress(context.output);
  Steering steering(plan.axes, context);
  const tmcl::client::Hearing<api::PathProgress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::PathProgress& news) { show(news, progress); });
  api::path::Run run;
  run.plan = plan.plan;
  run.to_start = true;
  auto report =
      context.call(run, {.timeout = longest_path_silence, .meanwhile = [&] { steering.look(); }});
  // What stopped it before its end has moved the axes, or not.
  if (!report && report.error().subject.contains("run")) {
    const bool moved = report.error().outcome != tmcl::Outcome::not_sent;
    report.error().kind = moved ? ErrorKind::ended_early : ErrorKind::not_now;
  }
  return {std::move(report), steering.signal()};
}

// ---- how it went ----

void print(const api::path::Passed& report, StreamMode mode, Output& output) {
  const bool by_position = mode == StreamMode::position;
  Table table({"AXIS", "LARGEST ERROR", "RMS", "READINGS"});
  for (const auto& axis : report.tracking_error)
    table.add({axis.axis, fmt::format("{:.4f}", axis.largest), fmt::format("{:.4f}", axis.rms),
               std::to_string(axis.readings)});
  table.print(output.out);
  output.out << fmt::format("seen at most {:.4f} off the path and {:.1f} ms late on it\n",
                            report.off_path, 1e3 * report.lag_s);
  output.out << fmt::format("{} {} in {:.3f} s, {} {:.1f} ms, at most {:.1f} ms late\n",
                            report.updates, by_position ? "legs" : "updates", report.passed_s,
                            mode == StreamMode::velocity ? "one every" : "the shortest takes",
                            report.period_ms, report.worst_delay_ms);
  output.out << fmt::format(
      "{:.0f} commands a second, {:.0f} us each: {:.0f} % of what the bus has\n",
      report.commands_per_s, report.round_trip_us, 100 * report.bus_load);
}

Result<ExitCode> tell(PathEnd end, StreamMode mode, Output& output) {
  if (end.report) {
    warn(end.report->remarks, output);
    if (output.json) {
      print_json(api::to_json(*end.report), output);
    } else {
      print(*end.report, mode, output);
    }
    return ExitCode::done;
  }
  auto failure = std::move(end.report.error());
  warn(path::part_done<api::path::Passage>(failure).remarks, output);
  if (end.signal == 0) return tl::unexpected(std::move(failure));
  return tl::unexpected(interrupted_error(end.signal, "stopped before the end of the path", "",
                                          std::move(failure.subject)));
}

}  // namespace

Result<ExitCode> run(const verb::RunPath& verb, Context& context) {
  const auto plan = plan_of(verb, context);
  if (!plan) return tl::unexpected(plan.error());
  warn(plan->warnings, context.output);
  if (!verb.svg.empty()) {
    const auto drawn =
        path::draw(verb.svg, verb.file, plan->course, plan->curve.value_or(api::path::Curve{}));
    if (!drawn) return tl::unexpected(drawn.error());
  }
  if (!verb.dry_run) {
    if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
    context.host.catch_pauses();
    return tell(pass(*plan, context), verb.mode, context.output);
  }
  if (context.output.json) {
    auto document = api::to_json(plan->course);
    document["file"] = verb.file;
    print_json(document, context.output);
  } else {
    path::print(verb.file, plan->course, context.output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

// path run.
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "command_line/form.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "path/path_source.hpp"
#include "path_words.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/system.hpp"

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
  params.name = verb.file;
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
  params.jerk = amount_of(verb.jerk);
  params.per_turn = verb.per_turn;
  params.deviation = verb.deviation;
  if (verb.shaping.shaper) params.shaper = name_of(*verb.shaping.shaper);
  params.resonance_hz = verb.shaping.resonance_hz;
  params.damping = verb.shaping.damping;
  if (verb.lenient) params.lenient = true;
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

PathEnd pass(const api::path::Planned& plan, bool is_drawn, Context& context) {
  ProgressLine progress(context.output);
  Steering steering(plan.axes, context);
  const tmcl::client::Hearing<api::PathProgress> hearing(
      context.gateway.caller, api::progress_notification,
      [&](const api::PathProgress& news) { show(news, progress); });
  api::path::Run run;
  run.plan = plan.plan;
  run.to_start = true;
  if (is_drawn) run.points = api::path::most_curve_points;
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

/// Also of a path that was ended early, where it had begun.
api::path::Passage passage_in(const PathEnd& end) {
  if (end.report) return *end.report;
  return path::part_done<api::path::Passage>(end.report.error());
}

Result<void> draw(const verb::RunPath& verb, const api::path::Planned& plan, OutputFile& svg,
                  std::optional<api::path::Passage> passage) {
  if (!svg.is_open()) return {};
  path::Drawn drawn;
  drawn.passage = std::move(passage);
  const auto curve = plan.curve.value_or(api::path::Curve{});
  return svg.write(path::to_svg(verb.file, plan.course, curve, drawn));
}

/// Of what its positions say, or its encoders.
template <class Passage>
void print_seen(const Passage& passage, const char* what, const char* who, Output& output) {
  Table table({what, "LARGEST ERROR", "RMS", "READINGS"});
  for (const auto& axis : passage.tracking_error)
    table.add({axis.axis, fmt::format("{:.4f}", axis.largest), fmt::format("{:.4f}", axis.rms),
               std::to_string(axis.readings)});
  table.print(output);
  output.out << fmt::format(
      "{}seen at most {:.4f} off the path, at {:.3f} s, {}, and {:.1f} ms late on it\n", who,
      passage.off_path, passage.off_path_at_s,
      path::tolerance_verdict(passage.tolerance_exceeded_by), 1e3 * passage.lag_s);
}

void print(const api::path::Passed& report, StreamMode mode, Output& output) {
  const bool by_position = mode == StreamMode::position;
  print_seen(report, "AXIS", "", output);
  if (report.motors) print_seen(*report.motors, "ENCODER OF", "motors ", output);
  output.out << fmt::format("{} {} in {:.3f} s, {} {:.1f} ms, at most {:.1f} ms late\n",
                            report.updates, by_position ? "legs" : "updates", report.passed_s,
                            mode == StreamMode::velocity ? "one every" : "the shortest takes",
                            report.period_ms, report.worst_delay_ms);
  output.out << fmt::format(
      "{:.0f} commands a second, {:.0f} us each: {:.0f} % of what the bus has\n",
      report.commands_per_s, report.round_trip_us, 100 * report.bus_load);
}

/// What was asked for to be drawn is not told as well.
void leave_out_places(boost::json::object& report) {
  report.erase(api::name_of<&api::path::Passage::seen>());
  report.erase(api::name_of<&api::path::Passage::on_path>());
  auto* motors = report.if_contains(api::name_of<&api::path::Passage::motors>());
  if (motors == nullptr || !motors->is_object()) return;
  motors->as_object().erase(api::name_of<&api::path::MotorPassage::seen>());
  motors->as_object().erase(api::name_of<&api::path::MotorPassage::on_path>());
}

Result<ExitCode> tell(PathEnd end, StreamMode mode, Output& output) {
  if (end.report) {
    warn(end.report->remarks, output);
    if (output.json) {
      auto document = api::to_json(*end.report);
      leave_out_places(document);
      print_json(document, output);
    } else {
      print(*end.report, mode, output);
    }
    return ExitCode::done;
  }
  auto failure = std::move(end.report.error());
  if (auto* part = failure.subject.if_contains("run")) leave_out_places(part->as_object());
  warn(path::part_done<api::path::Passage>(failure).remarks, output);
  if (end.signal == 0) return tl::unexpected(std::move(failure));
  return tl::unexpected(interrupted_error(end.signal, "stopped before the end of the path", "",
                                          std::move(failure.subject)));
}

void print(const std::vector<api::path::Expected>& expected, Output& output) {
  if (expected.empty()) return;
  Table table({"MODE", "EXPECTED OFF THE PATH", "AT", "LATE", "TOLERANCE"});
  for (const auto& mode : expected) {
    if (mode.refused) {
      table.add({mode.mode, "-", "-", "-", *mode.refused});
      continue;
    }
    table.add({mode.mode, fmt::format("{:.4f}", mode.off_path),
               fmt::format("{:.3f} s", mode.off_path_at_s),
               fmt::format("{:.1f} ms", 1e3 * mode.lag_s),
               mode.keeps_tolerance ? "kept" : "exceeded"});
  }
  output.out << '\n';
  table.print(output);
}

Result<ExitCode> run(const verb::RunPath& verb, Context& context) {
  const auto plan = plan_of(verb, context);
  if (!plan) return tl::unexpected(plan.error());
  warn(plan->warnings, context.output);
  OutputFile svg;
  if (auto opened = svg.open(verb.svg); !opened) return tl::unexpected(opened.error());
  if (!verb.dry_run) {
    if (auto interrupted = interrupted_before_move(context)) return tl::unexpected(*interrupted);
    context.host.catch_pauses();
    auto end = pass(*plan, svg.is_open(), context);
    const auto drawn = draw(verb, *plan, svg, passage_in(end));
    auto code = tell(std::move(end), verb.mode, context.output);
    return drawn || !code ? code : tl::unexpected(drawn.error());
  }
  if (auto drawn = draw(verb, *plan, svg, {}); !drawn) return tl::unexpected(drawn.error());
  if (context.output.json) {
    auto document = api::to_json(plan->course);
    document["file"] = verb.file;
    const auto whole = api::to_json(*plan);
    document["expected"] = whole.at("expected");
    document["shaping"] = whole.at("shaping");
    document["jerk"] = whole.at("jerk");
    document["warnings"] = boost::json::array(plan->warnings.begin(), plan->warnings.end());
    print_json(document, context.output);
  } else {
    path::print(verb.file, plan->course, context.output);
    if (plan->jerk) path::print(*plan->jerk, context.output);
    if (plan->shaping) path::print(*plan->shaping, context.output);
    print(plan->expected, context.output);
  }
  return ExitCode::done;
}

constexpr int shortest_period_ms = 1;
constexpr int longest_period_ms = 1000;

constexpr const char* path_run_help = R"(
Moves the axes along the path, and says then how far off it they were seen, and what the bus was used
for. G-code begins where the axes stand; to the start of a table they are moved first. X is the axis of
tmcld that is called X or x, unless --axis says otherwise. Nothing moves before everything is checked:
units, limits, where the path goes, that all axes stand, and what the bus can carry. Files are those of
'tmclctl path check', and so are the warnings of what is not carried out. --velocity, --acceleration
and --feed are in the units of the file, or have a unit with them: 20mm/s, 500mm/s^2, 120rpm.

  --mode velocity   any module: a new velocity for each axis every 5 ms, or as fast as the bus can
  --mode segments   any module, for slow buses: an axis is told a speed, and the acceleration to get
                    there, only where its speed changes; no table with times
  --mode position   modules with start and stop velocities (TMC5130, TMC5160 ...): line by line; no table
                    with times
--svg draws the path, where the axes were seen on it, and a ring where they were farthest off; and as a
line how far off they were, ten times as far. Where the configuration names encoders, these tell where the
motors were: they are read where an update leaves time, are printed as well, and are what is drawn.
--shape lets loads that swing hardly swing after the path, --jerk lets the acceleration along it change
gradually ('tmclctl path check --help' says how); --dry-run says what that costs. Not in position mode.
Ctrl-C stops all axes. So does a stop of one of them by another client, an axis that does not do what it
is told, and a computer or bus that is too slow. Ctrl-Z pauses on the path, and goes on. At M0 of G-code a
path waits until 'tmclctl path resume' lets it go on, or Ctrl-Z twice.
tmcld passes the path: once begun, it goes on to its end also if this program is killed. With --direct
nothing else could: if this program is killed, each axis stops at the end of its leg, in the
other modes where the path would next turn it round; those of a TMC4361 or of firmware ramps turn on.

  tmclctl path run part.ngc --axis X=left --axis Y=front
  tmclctl path run part.csv --axis x=left --axis y=front --mode position --velocity 20mm/s
  tmclctl --direct can:can0 path run part.ngc --axis X=1/0 --axis Y=1/1 --per-turn 5 --dry-run
)";

}  // namespace

void add_path_run(Grammar& grammar, const Form& group) {
  auto form = grammar.verb<verb::RunPath>(group, "run", access::tells, "Move axes along a path",
                                          path_run_help, run);
  add_path_file(form);
  auto& said = *form.operator->();
  form.repeated_option("--axis", "LETTER=AXIS", "Which axis the file's axis of this name is",
                       named_axes(said.axes));
  form.option("--mode", "MODE", "velocity (default), segments, or position",
              [&said](const std::string& text) -> Reading {
                const auto mode = tmcl::plan::stream_mode_named(text);
                if (!mode) {
                  return tl::unexpected(
                      fmt::format("'{}' is none of velocity, segments and position", text));
                }
                said.mode = *mode;
                return {};
              });
  form.option("--deviation", "UNITS",
              "Stop when an axis is seen so far off its plan (default 20 tolerances)",
              number(form->deviation, least_of_path, most_of_path));
  form.option("--feed", "UNITS|VELOCITY", "No faster along the path: a second, or such as 20mm/s",
              text(form->feed));
  form.option("--velocity", "UNITS|VELOCITY", "No axis faster than this; otherwise max_velocity",
              text(form->velocity));
  form.option(
      "--acceleration", "UNITS|ACCELERATION",
      "No axis with more: a second squared, or such as 500mm/s^2; otherwise the least of its own",
      text(form->acceleration));
  form.option("--corner-jump", "UNITS|VELOCITY",
              "By how much an axis may change its speed at once in a corner, such as 2mm/s",
              text(form->corner_jump));
  form.option("--per-turn", "UNITS", "What a turn of the motor is, for axes without a unit",
              number(form->per_turn, least_of_path, most_of_path));
  form.option(
      "--period", "MS", "In velocity mode, no updates more often than this (default 5)",
      [&said](const std::string& text) {
        return parse_number<int>(text, shortest_period_ms, longest_period_ms).map([&](int value) {
          said.period = std::chrono::milliseconds(value);
        });
      });
  form.option("--jerk", "UNITS|JERK",
              "By how much the acceleration along the path may change in a second, such as "
              "5000mm/s^3",
              text(form->jerk));
  add_shaping(form);
  form.object([](const verb::RunPath& verb, bool) {
    return objection_to(verb.shaping, !verb.jerk.empty());
  });
  form.flag("--dry-run", "Plan and check everything, say what each mode will keep; move nothing",
            form->dry_run);
}

}  // namespace tmclctl

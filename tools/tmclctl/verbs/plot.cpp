// plot.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "axis/prediction_text.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "plot/comparison.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"
#include "tmcl/utc_text.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr tmcl::Duration sample_interval = std::chrono::milliseconds(10);
// What the daemon remembers may come more than once; its age is not told more exactly than this.
constexpr double least_distance_s = 0.001;
constexpr tmcl::Duration tolerated_delay = std::chrono::milliseconds(25);
// An axis that stands for so long does not go on.
constexpr tmcl::Duration standstill_limit = std::chrono::seconds(1);
// An hour at one sample every 10 ms.
constexpr std::size_t most_recorded_samples = 360'000;

/// Collects samples, and shows that it does.
class Recorder {
 public:
  /// `internal`: in what the module counts.
  Recorder(std::string axis, bool internal, Context& context)
      : room_(context), internal_(internal), begin_(context.host.now()), line_(context.output) {
    recording_.axis = std::move(axis);
    recording_.begin_utc = context.host.utc();
  }

  void add(const AxisReading& reading) {
    has_unit_ = has_unit_ || reading.position;
    // One that took much longer than usual does not say when exactly it was taken; of an axis that
    // stands, that does not matter.
    const std::chrono::milliseconds age(reading.age_ms);
    usual_age_ = std::min<tmcl::Duration>(usual_age_, age);
    if (reading.moving && age > usual_age_ + tolerated_delay) return;
    auto& samples = recording_.samples;
    const double since_begin_s = std::chrono::duration<double>(reading.taken_at - begin_).count();
    // The first one counts for the beginning, although it may be a little older or younger.
    const double time_s = samples.empty() ? 0 : since_begin_s;
    if (full() || (!samples.empty() && time_s < samples.back().time + least_distance_s)) return;
    samples.push_back({time_s, reading.position_microsteps, reading.velocity_internal,
                       std::chrono::duration<double>(age).count()});
    line_.show(fmt::format("recording {}: {:.1f} s  position {}  velocity {}", recording_.axis,
                           time_s, position_text(reading, internal_),
                           velocity_text(reading, internal_)));
  }

  bool full() const { return recording_.samples.size() >= most_recorded_samples; }
  double seconds() const {
    return std::chrono::duration<double>(room_.host.now() - begin_).count();
  }

  /// What the recording is to be compared with.
  void expect(const tmcl::plan::AxisTwin& twin, plot::Start start) {
    twin_ = twin;
    start_ = start;
  }
  std::optional<plot::Comparison> comparison() const {
    if (!twin_ || recording_.samples.empty()) return std::nullopt;
    return plot::compare(recording_, *twin_, start_);
  }

  /// Drawn in the unit of the axis if it has one.
  const plot::Recording& finish() {
    line_.clear();
    if (internal_ || !has_unit_) return recording_;
    auto units = units_of(recording_.axis, room_);
    // Whatever comes of it: there is something to draw.
    if (units && units->scale && units->module)
      plot::use({std::move(*units->scale), *units->module}, recording_);
    return recording_;
  }

 private:
  Context& room_;
  bool internal_;
  tmcl::TimePoint begin_;
  tmcl::Duration usual_age_ = tmcl::Duration::max() / 2;
  ProgressLine line_;
  plot::Recording recording_;
  bool has_unit_ = false;
  std::optional<tmcl::plan::AxisTwin> twin_;
  plot::Start start_;
};

using MaybeFailure = std::optional<Error>;

MaybeFailure record_move(const verb::Plot& verb, Recorder& recorder, Context& context) {
  const auto before = state_of(verb.axis, context);
  if (!before) return before.error();
  recorder.add(*before);
  if (auto interrupted = interrupted_before_move(context)) return interrupted;
  std::optional<tmcl::plan::AxisTwin> twin;
  if (verb.compare) {
    const auto found = twin_of(verb.axis, context);
    if (!found) return found.error();
    twin = *found;
  }
  const double asked_at = recorder.seconds();
  const bool by = !verb.by.empty();
  const auto move = start_move(verb.axis, {by ? verb.by : verb.to, verb.internal}, by, context);
  if (!move) return move.error();
  if (twin) {
    twin->move_to({move->target_microsteps});
    recorder.expect(*twin, {asked_at, recorder.seconds()});
  }
  Journey journey{verb.axis, {move->target_microsteps}, context.host.now(), sample_interval, {},
                  {}};
  if (!verb.internal) journey.goal_in_unit = in_unit(move->target, move->unit);
  if (verb.for_s) {
    journey.timeout =
        std::chrono::duration_cast<tmcl::Duration>(std::chrono::duration<double>(*verb.for_s));
  }
  const auto reached =
      follow(journey, context, [&](const AxisReading& reading) { recorder.add(reading); });
  // The end of the time that --for gives is what was asked for.
  if (reached || reached.error().name == "timeout") return std::nullopt;
  return reached.error();
}

MaybeFailure record_as_it_is(const verb::Plot& verb, Recorder& recorder, Context& context) {
  auto last_moving = context.host.now();
  while (context.host.signal() == 0 && !recorder.full()) {
    const auto next_look = context.host.now() + sample_interval;
    const auto reading = state_of(verb.axis, context);
    if (!reading && context.host.signal() != 0) break;
    if (!reading) return reading.error();
    recorder.add(*reading);
    if (verb.for_s && recorder.seconds() >= *verb.for_s) return std::nullopt;
    if (reading->moving) last_moving = context.host.now();
    const bool stands = context.host.now() - last_moving >= standstill_limit;
    if (!verb.for_s && stands) return std::nullopt;
    context.sleep(next_look - context.host.now());
  }
  if (context.host.signal() == 0) return std::nullopt;
  return interrupted_error(context.host.signal(), fmt::format("no longer recording {}", verb.axis),
                           "If it moves, it goes on. " + how_to_stop(verb.axis, context));
}

json::object to_json(const plot::Comparison& comparison, const plot::Recording& recording) {
  const auto largest = std::abs(plot::shown_position(comparison.largest, recording));
  return {{"planned_microsteps", json::array(comparison.planned.begin(), comparison.planned.end())},
          {"largest_difference_microsteps", comparison.largest},
          {"largest_difference", recording.user ? json::value(largest) : json::value(nullptr)},
          {"largest_difference_at_s", comparison.largest_at}};
}

json::object to_json(const verb::Plot& verb, const plot::Recording& recording,
                     const std::optional<plot::Comparison>& comparison) {
  json::array times;
  json::array positions;
  json::array velocities;
  for (const auto& sample : recording.samples) {
    times.push_back(sample.time);
    positions.push_back(sample.position);
    velocities.push_back(sample.velocity);
  }
  const auto values_of = [&](const plot::Curve& curve) -> json::value {
    if (!recording.user) return nullptr;
    return json::array(curve.values.begin(), curve.values.end());
  };
  return {{"axis", verb.axis},
          {"begin_utc", tmcl::to_text(recording.begin_utc.value())},
          {"time_s", std::move(times)},
          {"position_microsteps", std::move(positions)},
          {"velocity_internal", std::move(velocities)},
          {"unit", recording.user ? json::value(recording.user->scale.unit) : json::value(nullptr)},
          {"position", values_of(plot::position_curve(recording))},
          {"velocity", values_of(plot::velocity_curve(recording))},
          {"comparison",
           comparison ? json::value(to_json(*comparison, recording)) : json::value(nullptr)},
          {"svg", verb.svg.empty() ? json::value(nullptr) : json::value(verb.svg)},
          {"csv", verb.csv.empty() ? json::value(nullptr) : json::value(verb.csv)}};
}

void show(const verb::Plot& verb, const plot::Recording& recording, const plot::Picture& picture,
          Output& output) {
  if (verb.csv == "-") {
    output.out << plot::to_csv(recording, verb.show);
  } else {
    output.out << plot::to_text(picture, output.out_screen);
  }
}

Result<ExitCode> run(const verb::Plot& verb, Context& context) {
  // A move whose recording cannot be kept is not worth starting.
  OutputFile svg;
  OutputFile csv;
  if (auto opened = svg.open(verb.svg); !opened) return tl::unexpected(opened.error());
  if (auto opened = csv.open(verb.csv == "-" ? "" : verb.csv); !opened)
    return tl::unexpected(opened.error());
  Recorder recorder(verb.axis, verb.internal, context);
  const bool starts_move = !verb.to.empty() || !verb.by.empty();
  const auto failure =
      starts_move ? record_move(verb, recorder, context) : record_as_it_is(verb, recorder, context);
  const auto& recording = recorder.finish();
  const auto comparison = recorder.comparison();
  // A move that was refused has been seen once, where it did not begin.
  const bool began = !failure || recording.samples.size() > 1;
  if (began && !recording.samples.empty()) {
    const auto picture = comparison ? plot::picture_of(recording, *comparison, verb.show)
                                    : plot::picture_of(recording, verb.show);
    if (auto written = svg.write(plot::to_svg(picture)); !written)
      return tl::unexpected(written.error());
    if (auto written = csv.write(plot::to_csv(recording, verb.show)); !written)
      return tl::unexpected(written.error());
    if (!context.output.json) show(verb, recording, picture, context.output);
  }
  if (failure) return tl::unexpected(*failure);
  if (context.output.json) print_json(to_json(verb, recording, comparison), context.output);
  return ExitCode::done;
}

constexpr const char* plot_help = R"(
Records position and velocity, and draws both over time, or what --show names: acceleration and jerk
are how fast the recorded velocity changes, as rough as that is, and columns of the CSV then. With --to or --by it starts that move and
records until the axis stands; otherwise it records until the axis stands, or for the time that
--for gives. Ctrl-C ends the recording, not the move, and draws what there is. An axis with a unit is
drawn in that, and its CSV has two columns more.

--compare draws beside the movement what the module's ramp generator should make of it, and says by
how much the two differ: beyond what the time can explain that command and readings took.

  tmclctl plot x --by 51200
  tmclctl plot x --by 51200 --compare
  tmclctl plot x --by 51200 --show v,a
  tmclctl plot x --to 0 --svg move.svg --csv move.csv
  tmclctl rotate x 500 --unattended; tmclctl plot x --for 3
  tmclctl plot x --by 1000 --csv -               CSV on standard output, no drawing
)";

}  // namespace

void add_plot(Grammar& grammar) {
  auto plot = grammar.verb<verb::Plot>(
      "plot", access::acts, "Record a movement and draw position and velocity", plot_help, run);
  plot.axis(plot->axis);
  plot.option("--to", "POSITION", "Start a move to this position", text(plot->to));
  plot.option("--by", "DISTANCE", "Start a move by this distance", text(plot->by));
  plot.option("--for", "SECONDS", "Record for so long at most",
              number(plot->for_s, shortest_time_s, longest_time_s));
  plot.option("--svg", "FILE", "Write the drawing to this file, too", svg_file(plot->svg));
  plot.option("--csv", "FILE",
              "Write the samples to this file, too; '-': to standard output instead",
              text(plot->csv));
  plot::add_show(plot, plot->show);
  plot.flag("--compare", "Draw the plan of the move as well, and how far the axis was off it",
            plot->compare);
  plot.internal(plot->internal);
  plot.object([](const verb::Plot& said, bool json) {
    if (said.compare && said.to.empty() && said.by.empty())
      return "--compare needs a move: --to or --by";
    if (!said.to.empty() && !said.by.empty()) return "--to and --by exclude each other";
    return json && said.csv == "-" ? "--json and '--csv -' both want standard output" : "";
  });
}

}  // namespace tmclctl

// plot.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "axis/prediction_text.hpp"
#include "axis/recording_csv.hpp"
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
// Of all axes together: an hour of one at a sample every 10 ms.
constexpr std::size_t most_recorded_samples = 360'000;

bool has_changes(const plot::Shown& shown) {
  return std::ranges::any_of(shown, [](plot::Quantity quantity) {
    return quantity == plot::Quantity::acceleration || quantity == plot::Quantity::jerk;
  });
}

/// Collects samples, and shows that it does.
class Recorder {
 public:
  Recorder(const verb::Plot& verb, RecordingCsv& csv, Context& context)
      : verb_(verb), csv_(csv), room_(context), line_(context.output) {}

  /// Finds out what is to be recorded.
  Result<void> begin() {
    for (const auto& axis : verb_.axes) {
      auto recording = begin_recording(axis, verb_.also, verb_.internal, room_);
      if (!recording) return tl::unexpected(recording.error());
      if (!find(recording->axis)) recordings_.push_back(std::move(*recording));
    }
    tracks_.resize(recordings_.size());
    for (auto& recording : recordings_) recording.begin_utc = room_.host.utc();
    csv_.begin(recordings_);
    // It begins when all that is known.
    begin_ = room_.host.now();
    for (auto& recording : recordings_) recording.begin_utc = room_.host.utc();
    return {};
  }

  void add(const AxisReading& reading) {
    const auto axis = find(reading.axis);
    if (!axis || full()) return;
    auto& recording = recordings_[*axis];
    auto& track = tracks_[*axis];
    track.heard_at = room_.host.now();
    if (reading.moving) moving_at_ = track.heard_at;
    if (reading.samples.empty()) {
      auto with_samples = reading;
      with_samples.samples = track.samples;
      for (auto& sample : with_samples.samples)
        sample.age_ms += in_ms(track.heard_at - track.sampled_at);
      return add(with_samples, recording, track);
    }
    track.samples = reading.samples;
    track.sampled_at = track.heard_at;
    add(reading, recording, track);
  }

  bool full() const { return recorded_ >= most_recorded_samples; }
  double seconds() const {
    return std::chrono::duration<double>(room_.host.now() - begin_).count();
  }
  /// Since any of them was seen to move.
  tmcl::Duration stands_for() const { return room_.host.now() - std::max(moving_at_, begin_); }
  /// One of which nothing has come lately; null if there is none.
  const std::string* silent_axis() const {
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const auto heard_at = std::max(tracks_[i].heard_at, begin_);
      if (room_.host.now() - heard_at >= doubtful_silence) return &recordings_[i].axis;
    }
    return nullptr;
  }
  /// By the names that the gateway has for them.
  std::vector<std::string> axes() const {
    std::vector<std::string> names;
    for (const auto& recording : recordings_) names.push_back(recording.axis);
    return names;
  }

  /// What the first one is to be compared with.
  void expect(const tmcl::plan::AxisTwin& twin, plot::Start start) {
    twin_ = twin;
    start_ = start;
  }
  std::optional<plot::Comparison> comparison() const {
    if (!twin_ || recordings_.front().samples.empty()) return std::nullopt;
    return plot::compare(recordings_.front(), *twin_, start_);
  }

  /// Writes what was not written as it came.
  const std::vector<plot::Recording>& finish() {
    line_.clear();
    if (csv_.is_wanted() && recorded_ > 0 && !is_written_) write();
    return recordings_;
  }
  bool has_recorded() const { return recorded_ > 0; }
  /// A move that was refused has been seen once, where it did not begin.
  bool has_recorded_a_while() const { return recorded_ > recordings_.size(); }

 private:
  /// Of one axis.
  struct Track {
    tmcl::Duration usual_age = tmcl::Duration::max() / 2;
    tmcl::TimePoint heard_at{};
    std::vector<tmcl::api::Sample> samples{};  ///< That came last.
    tmcl::TimePoint sampled_at{};
  };

  static std::int64_t in_ms(tmcl::Duration duration) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
  }
  std::optional<std::size_t> find(const std::string& axis) const {
    const auto found = std::ranges::find(recordings_, axis, &plot::Recording::axis);
    if (found == recordings_.end()) return std::nullopt;
    return static_cast<std::size_t>(found - recordings_.begin());
  }

  void add(const AxisReading& reading, plot::Recording& recording, Track& track) {
    // One that took much longer than usual does not say when exactly it was taken; of an axis that
    // stands, that does not matter.
    const std::chrono::milliseconds age(reading.age_ms);
    track.usual_age = std::min<tmcl::Duration>(track.usual_age, age);
    if (reading.moving && age > track.usual_age + tolerated_delay) return;
    auto& samples = recording.samples;
    const double since_begin_s = std::chrono::duration<double>(reading.taken_at - begin_).count();
    // The first one counts for the beginning, although it may be a little older or younger.
    const double time_s = samples.empty() ? 0 : since_begin_s;
    if (!samples.empty() && time_s < samples.back().time + least_distance_s) return;
    samples.push_back(sample_of(reading, time_s, recording));
    ++recorded_;
    write_as_it_goes(recording);
    line_.show(fmt::format("recording {}: {:.1f} s  position {}  velocity {}", recording.axis,
                           time_s, position_text(reading, verb_.internal),
                           velocity_text(reading, verb_.internal)));
  }

  void write_as_it_goes(const plot::Recording& recording) {
    // How fast the velocity changes is known at the end.
    if (!csv_.is_wanted() || has_changes(verb_.show) || !has_recorded_a_while()) return;
    if (is_written_) return csv_.add(recording, recording.samples.back());
    write();
  }
  /// What there is.
  void write() {
    is_written_ = true;
    if (has_changes(verb_.show)) return csv_.add(recordings_.front(), verb_.show);
    for (const auto& recording : recordings_)
      for (const auto& sample : recording.samples) csv_.add(recording, sample);
  }

  const verb::Plot& verb_;
  RecordingCsv& csv_;
  Context& room_;
  tmcl::TimePoint begin_{};
  tmcl::TimePoint moving_at_{};
  ProgressLine line_;
  std::vector<plot::Recording> recordings_;
  std::vector<Track> tracks_;  ///< Of each of them.
  std::size_t recorded_ = 0;
  bool is_written_ = false;
  std::optional<tmcl::plan::AxisTwin> twin_;
  plot::Start start_;
};

using MaybeFailure = std::optional<Error>;

MaybeFailure look(Recorder& recorder, Context& context) {
  for (const auto& axis : recorder.axes()) {
    const auto reading = state_of(axis, context);
    if (!reading) return reading.error();
    recorder.add(*reading);
  }
  return std::nullopt;
}

MaybeFailure record_move(const verb::Plot& verb, Recorder& recorder, Context& context) {
  if (auto failure = look(recorder, context)) return failure;
  if (auto interrupted = interrupted_before_move(context)) return interrupted;
  auto axes = recorder.axes();
  const auto axis = axes.front();
  std::optional<tmcl::plan::AxisTwin> twin;
  if (verb.compare) {
    const auto found = twin_of(axis, context);
    if (!found) return found.error();
    twin = *found;
  }
  const double asked_at = recorder.seconds();
  const bool by = !verb.by.empty();
  const auto move = start_move(axis, {by ? verb.by : verb.to, verb.internal}, by, context);
  if (!move) return move.error();
  if (twin) {
    twin->move_to({move->target_microsteps});
    recorder.expect(*twin, {asked_at, recorder.seconds()});
  }
  Journey journey{axis, {move->target_microsteps}, context.host.now(), sample_interval, {}, {}};
  axes.erase(axes.begin());
  // Who records more than one movement wants to know when the rest was so, too.
  journey.beside = {axes, verb.also, !axes.empty() || !verb.also.empty()};
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
  if (auto failure = look(recorder, context)) return failure;
  MaybeFailure failure;
  const auto goes_on = [&] {
    if (failure || context.host.signal() != 0 || recorder.full()) return false;
    if (verb.for_s && recorder.seconds() >= *verb.for_s) return false;
    if (!verb.for_s && recorder.stands_for() >= standstill_limit) return false;
    const auto* silent = recorder.silent_axis();
    if (silent == nullptr) return true;
    const auto reading = state_of(*silent, context);
    if (reading) recorder.add(*reading);
    if (!reading) failure = reading.error();
    return !failure;
  };
  const AxesWatcher watcher{
      .on_reading = [&](const auto&, const auto& reading) { recorder.add(reading); },
      .on_error = [&](const auto&, const auto& error) { failure = error; },
      .on_event = {},
      .wanted = goes_on};
  const auto watched =
      watch_axes({recorder.axes(), sample_interval, verb.also, true}, watcher, context);
  if (context.host.signal() == 0) return watched ? failure : watched.error();
  const auto names = joined(recorder.axes());
  return interrupted_error(
      context.host.signal(), "no longer recording " + names,
      "If it moves, it goes on. " + how_to_stop(recorder.axes().front(), context));
}

json::object to_json(const plot::Comparison& comparison, const plot::Recording& recording) {
  const auto largest = std::abs(plot::shown_position(comparison.largest, recording));
  return {{"planned_microsteps", json::array(comparison.planned.begin(), comparison.planned.end())},
          {"largest_difference_microsteps", comparison.largest},
          {"largest_difference", recording.user ? json::value(largest) : json::value(nullptr)},
          {"largest_difference_at_s", comparison.largest_at}};
}

json::array to_json(const plot::Recording& recording, std::size_t also) {
  json::array values;
  for (const auto& sample : recording.samples) {
    const auto& value = also < sample.also.size() ? sample.also[also] : std::nullopt;
    values.push_back(value ? json::value(value->value) : json::value(nullptr));
  }
  return values;
}

json::object to_json(const plot::Recording& recording) {
  json::array times;
  json::array positions;
  json::array velocities;
  for (const auto& sample : recording.samples) {
    times.push_back(sample.time);
    positions.push_back(sample.position);
    velocities.push_back(sample.velocity);
  }
  json::object also;
  for (std::size_t i = 0; i < recording.also.size(); ++i)
    also[recording.also[i].name] = to_json(recording, i);
  const auto values_of = [&](const plot::Curve& curve) -> json::value {
    if (!recording.user) return nullptr;
    return json::array(curve.values.begin(), curve.values.end());
  };
  return {{"axis", recording.axis},
          {"begin_utc", tmcl::to_text(recording.begin_utc.value())},
          {"time_s", std::move(times)},
          {"position_microsteps", std::move(positions)},
          {"velocity_internal", std::move(velocities)},
          {"unit", recording.user ? json::value(recording.user->scale.unit) : json::value(nullptr)},
          {"position", values_of(plot::position_curve(recording))},
          {"velocity", values_of(plot::velocity_curve(recording))},
          {"also", std::move(also)}};
}

json::object to_json(const verb::Plot& verb, const std::vector<plot::Recording>& recordings,
                     const std::optional<plot::Comparison>& comparison) {
  const auto& first = recordings.front();
  auto document = to_json(first);
  json::array beside;
  for (std::size_t i = 1; i < recordings.size(); ++i) beside.push_back(to_json(recordings[i]));
  document["beside"] = std::move(beside);
  document["comparison"] =
      comparison ? json::value(to_json(*comparison, first)) : json::value(nullptr);
  document["svg"] = verb.svg.empty() ? json::value(nullptr) : json::value(verb.svg);
  document["csv"] = verb.csv.empty() ? json::value(nullptr) : json::value(verb.csv);
  return document;
}

plot::Picture picture_of(const verb::Plot& verb, const std::vector<plot::Recording>& recordings,
                         const std::optional<plot::Comparison>& comparison) {
  const auto& first = recordings.front();
  auto picture = comparison ? plot::picture_of(first, *comparison, verb.show)
                            : plot::picture_of(first, verb.show);
  if (recordings.size() > 1) plot::name_after(first.axis, picture);
  for (std::size_t i = 1; i < recordings.size(); ++i) plot::add(recordings[i], verb.show, picture);
  return picture;
}

Result<ExitCode> run(const verb::Plot& verb, Context& context) {
  // A move whose recording cannot be kept is not worth starting.
  OutputFile svg;
  RecordingCsv csv(context);
  if (auto opened = svg.open(verb.svg); !opened) return tl::unexpected(opened.error());
  if (auto opened = csv.open(verb.csv); !opened) return tl::unexpected(opened.error());
  Recorder recorder(verb, csv, context);
  if (auto begun = recorder.begin(); !begun)
    return tl::unexpected(interrupted_before_move(context).value_or(begun.error()));
  const bool starts_move = !verb.to.empty() || !verb.by.empty();
  const auto failure =
      starts_move ? record_move(verb, recorder, context) : record_as_it_is(verb, recorder, context);
  if (failure && !recorder.has_recorded_a_while()) return tl::unexpected(*failure);
  const auto& recordings = recorder.finish();
  const auto comparison = recorder.comparison();
  if (recorder.has_recorded()) {
    const auto picture = picture_of(verb, recordings, comparison);
    if (auto written = svg.write(plot::to_svg(picture)); !written)
      return tl::unexpected(written.error());
    if (!csv.written()) return tl::unexpected(csv.written().error());
    if (!context.output.json && verb.csv != "-")
      context.output.out << plot::to_text(picture, context.output.out_screen);
  }
  if (failure) return tl::unexpected(*failure);
  if (context.output.json) print_json(to_json(verb, recordings, comparison), context.output);
  return ExitCode::done;
}

constexpr const char* plot_help = R"(
Records position and velocity, and draws both over time, or what --show names: acceleration and jerk
are how fast the recorded velocity changes, as rough as that is, and columns of the CSV then. With --to or --by it starts that move and
records until the axis stands; otherwise it records until the axis stands, or for the time that
--for gives. Ctrl-C ends the recording, not the move, and draws what there is. An axis with a unit is
drawn in that, and its CSV has two columns more.

Several axes are recorded together; the first is the one that is moved. --also records further
parameters, 8 at most, each as often as the bus has room for it: the CSV has the age of each value,
before the row that it stands in. The CSV is written as it goes, under comments ("# ") that say what
it is of: versions, the time of day (UTC), units and parameters. Of several axes each row names its
own.

--compare draws beside the movement what the module's ramp generator should make of it, and says by
how much the two differ: beyond what the time can explain that command and readings took.

  tmclctl plot x --by 51200
  tmclctl plot x --by 51200 --compare
  tmclctl plot x --by 51200 --show v,a
  tmclctl plot x y --by 51200 --also load_value,actual_current --csv load.csv
  tmclctl plot x --to 0 --svg move.svg --csv move.csv
  tmclctl rotate x 500 --unattended; tmclctl plot x --for 3
  tmclctl plot x --by 1000 --csv -               CSV on standard output, no drawing
)";

}  // namespace

void add_plot(Grammar& grammar) {
  auto plot = grammar.verb<verb::Plot>(
      "plot", access::acts, "Record a movement and draw position and velocity", plot_help, run);
  plot.words("AXIS", axis_meaning, texts(plot->axes));
  plot.option("--to", "POSITION", "Start a move to this position", text(plot->to));
  plot.option("--by", "DISTANCE", "Start a move by this distance", text(plot->by));
  plot.option("--for", "SECONDS", "Record for so long at most",
              number(plot->for_s, shortest_time_s, longest_time_s));
  plot.option("--svg", "FILE", "Write the drawing to this file, too", svg_file(plot->svg));
  plot.option("--csv", "FILE",
              "Write the samples to this file, too; '-': to standard output instead",
              text(plot->csv));
  plot::add_show(plot, plot->show);
  plot.option("--also", "PARAM,...", also_meaning, list(plot->also));
  plot.flag("--compare", "Draw the plan of the move as well, and how far the axis was off it",
            plot->compare);
  plot.internal(plot->internal);
  plot.object([](const verb::Plot& said, bool json) {
    if (said.axes.empty()) return "name at least one AXIS";
    if (said.axes.size() > 1 && !said.csv.empty() && has_changes(said.show))
      return "the CSV of several axes has no columns for --show a and j";
    if (said.compare && said.to.empty() && said.by.empty())
      return "--compare needs a move: --to or --by";
    if (!said.to.empty() && !said.by.empty()) return "--to and --by exclude each other";
    return json && said.csv == "-" ? "--json and '--csv -' both want standard output" : "";
  });
}

}  // namespace tmclctl

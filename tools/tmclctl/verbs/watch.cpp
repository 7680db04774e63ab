// watch
#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "axis/axis_rows.hpp"
#include "axis/recording_csv.hpp"
#include "command_line/method_words.hpp"
#include "connection/reconnecting_watch.hpp"
#include "output/print.hpp"
#include "tmcl/api/system.hpp"
#include "tmcl/utc_text.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

// What becomes of links and modules; what axes do is seen in their states.
constexpr auto told_events = std::to_array<std::string_view>(
    {"module_silent", "module_answers", "module_in_bootloader", "module_reset", "module_replaced",
     "settings_drift", "duplicate_address", "owner_lost", "axis_fault", "link_lost",
     "link_restored", "link_condition", "configuration_loaded"});

boost::json::array samples_of(const AxisReading& reading) {
  boost::json::array samples;
  for (const auto& sample : reading.samples) samples.push_back(api::to_json(sample));
  return samples;
}

/// What is told of an axis, but for how old it is.
boost::json::object news_of(AxisReading reading) {
  reading.age_ms = 0;
  for (auto& sample : reading.samples) sample.age_ms = 0;
  auto news = api::to_json<api::axis::State>(reading);
  news["samples"] = samples_of(reading);
  return news;
}

/// "  load_value 17"
std::string samples_text(const AxisReading& reading, bool internal) {
  std::string text;
  for (const auto& sample : reading.samples) {
    const auto value = internal ? std::nullopt : in_unit(sample.value_in_unit, sample.unit);
    text += fmt::format("  {} {}", name_of(sample), shown(value, sample.value));
  }
  return text;
}

/// Axes as they are when the watching begins. Errors: of a parameter that one does not have.
Result<std::vector<plot::Recording>> begin_recordings(const std::vector<std::string>& axes,
                                                      const verb::Watch& verb, Context& context) {
  std::vector<plot::Recording> recordings;
  std::vector<plot::AlsoRecorded> also;
  for (const auto& parameter : verb.also) also.push_back({parameter});
  for (const auto& axis : axes) {
    auto recording = begin_recording(axis, verb.also, verb.internal, context);
    if (!recording && recording.error().kind == ErrorKind::bad_request)
      return tl::unexpected(recording.error());
    // One that does not answer is watched all the same.
    if (recording) also = recording->also;
    recordings.push_back(recording ? std::move(*recording) : plot::Recording{axis, {}});
  }
  for (auto& recording : recordings)
    if (recording.also.empty()) recording.also = also;
  return recordings;
}

std::string condition_text(const AxisReading& reading) {
  const auto* at_rest = reading.position_reached ? "at target" : "stands";
  const auto flags = flags_text(reading);
  return (reading.moving ? "moving" : at_rest) + (flags.empty() ? "" : "  " + flags);
}

/// Prints what is told of axes, and says for how long that is wanted.
class Watching {
 public:
  Watching(const verb::Watch& verb, Context& context)
      : verb_(verb),
        output_(context.output),
        host_(context.host),
        begin_(context.host.now()),
        csv_(context) {}

  /// Errors: the file cannot be written; a parameter that an axis does not have.
  Result<void> begin(const std::vector<std::string>& axes, Context& context) {
    if (verb_.csv.empty()) return {};
    if (auto opened = csv_.open(verb_.csv); !opened) return opened;
    auto recordings = begin_recordings(axes, verb_, context);
    if (!recordings) return tl::unexpected(recordings.error());
    recordings_ = std::move(*recordings);
    for (auto& recording : recordings_) recording.begin_utc = host_.utc();
    csv_.begin(recordings_);
    begin_ = host_.now();
    for (auto& recording : recordings_) recording.begin_utc = host_.utc();
    return {};
  }
  const Result<void>& written() const { return csv_.written(); }

  AxesWatcher watcher() {
    return {.on_reading = [this](const auto& axis, const auto& reading) { tell(axis, reading); },
            .on_error =
                [this](const auto& axis, const auto& failure) {
                  tell("failed", axis + ": " + with_verbs(failure.message),
                       error_document(failure));
                },
            .on_event = [this](const auto& event) { tell(event); },
            .wanted =
                [this] {
                  const bool is_over = verb_.for_s && passed_s() >= *verb_.for_s;
                  return host_.signal() == 0 && !is_over && csv_.written();
                }};
  }
  void tell_away(const Error* why) {
    if (why == nullptr) return tell("away", "tmcld is there again", nullptr);
    tell("away", with_verbs(why->message), error_document(*why));
  }

 private:
  double passed_s() const { return std::chrono::duration<double>(host_.now() - begin_).count(); }
  void tell(const std::string& axis, const AxisReading& reading);
  void record(const AxisReading& reading);
  /// Whether standard output is for rows alone.
  bool is_silent() const { return verb_.csv == "-"; }
  void tell(const api::Event& event);
  /// What is no reading; `key` is what its document has it under.
  void tell(std::string_view key, const std::string& text, boost::json::value document);

  const verb::Watch& verb_;
  Output& output_;
  Host& host_;
  tmcl::TimePoint begin_;
  std::map<std::string, boost::json::object> last_;
  std::map<std::string, std::string> last_text_;
  RecordingCsv csv_;
  std::vector<plot::Recording> recordings_;  ///< Without samples: rows go to the file at once.
};

void Watching::record(const AxisReading& reading) {
  if (recordings_.empty()) return;
  auto recording = std::ranges::find(recordings_, reading.axis, &plot::Recording::axis);
  if (recording == recordings_.end()) {
    // It did not answer at first, and was named by its address.
    auto another = recordings_.front();
    another.axis = reading.axis;
    another.user.reset();
    recording = recordings_.insert(recordings_.end(), std::move(another));
  }
  const auto since_begin = std::chrono::duration<double>(reading.taken_at - begin_).count();
  csv_.add(*recording, sample_of(reading, std::max(since_begin, 0.0), *recording));
}

void Watching::tell(const std::string& axis, const AxisReading& reading) {
  auto& last = last_[axis];
  if (auto news = news_of(reading); news != last) {
    last = std::move(news);
  } else {
    return;
  }
  record(reading);
  if (is_silent()) return;
  if (output_.json) {
    auto document = api::to_json<api::axis::State>(reading);
    document["samples"] = samples_of(reading);
    document["time_s"] = passed_s();
    document["utc"] = tmcl::to_text(host_.utc());
    return print_json(document, output_);
  }
  const auto text = fmt::format(
      "{}  position {}  velocity {}  target {}{}  {}", axis, position_text(reading, verb_.internal),
      velocity_text(reading, verb_.internal), target_text(reading, verb_.internal),
      samples_text(reading, verb_.internal), condition_text(reading));
  // Not all that a document has is in a line.
  if (std::exchange(last_text_[axis], text) == text) return;
  output_.out << fmt::format("{:9.3f} s  {}", passed_s(), text) << std::endl;
}

void Watching::tell(const api::Event& event) {
  if (std::ranges::find(told_events, event.kind) == told_events.end()) return;
  tell("event", fmt::format("{}: {}", event.bus, event.text), api::to_json(event));
}

void Watching::tell(std::string_view key, const std::string& text, boost::json::value document) {
  if (output_.json)
    return print_json(
        {{key, std::move(document)}, {"time_s", passed_s()}, {"utc", tmcl::to_text(host_.utc())}},
        output_);
  auto& stream = is_silent() ? output_.err : output_.out;
  stream << fmt::format("{:9.3f} s  {}", passed_s(), text) << std::endl;
}

Result<ExitCode> run(const verb::Watch& verb, Context& context) {
  auto axes = verb.axes;
  if (verb.all) {
    const auto rows = axes_of(context);
    if (!rows) return tl::unexpected(rows.error());
    for (const auto& row : *rows) axes.push_back(row.name);
    if (axes.empty()) return tl::unexpected(usage_error("no_axes", "there are no axes to watch"));
  }
  Watching watching(verb, context);
  if (auto begun = watching.begin(axes, context); !begun) return tl::unexpected(begun.error());
  const auto watched = keep_watching(
      {axes, verb.interval, verb.also}, watching.watcher(),
      [&](const Error* why) { watching.tell_away(why); }, context);
  if (!watched) return tl::unexpected(watched.error());
  if (!watching.written()) return tl::unexpected(watching.written().error());
  return ExitCode::done;
}

constexpr const char* watch_help = R"(
One line for each change of some axes or of all, until Ctrl-C (exit code 0) or the end of --for, in the
unit of the axis if it has one. With --json, one document a line. It stays while modules do not answer, a
bus is lost or tmcld starts again, and says so; documents of that have "event" or "away" instead of "axis".

--also reads further parameters as well, 8 at most, each as often as the bus has room for it. --csv writes
a row for each change as it goes, under comments ("# ") that say what it is of: versions, the time of day
(UTC), units and parameters; each parameter has its age before the row. With '--csv -' all else goes to
standard error.

  tmclctl watch x
  tmclctl watch x y --also load_value,actual_current --csv load.csv
  tmclctl watch --all
  tmclctl --json watch x y --interval 50 --for 10
)";

}  // namespace

void add_watch(Grammar& grammar) {
  auto watch = grammar.verb<verb::Watch>("watch", access::reads, "Show every change of axes",
                                         watch_help, run);
  watch.words("AXIS", axis_meaning, texts(watch->axes));
  watch.flag("--all", "Every axis there is", watch->all);
  watch.object(
      [](const verb::Watch& said, bool json) {
        if (said.axes.empty() != said.all) return "name one AXIS or more, or say --all";
        return json && said.csv == "-" ? "--json and '--csv -' both want standard output" : "";
      },
      "'tmclctl axes' lists the axes");
  auto& interval = watch->interval;
  watch.option("--interval", "MS", "At most one line in so many milliseconds (default 100)",
               milliseconds(interval));
  watch.option("--for", "SECONDS", "End after so long",
               number(watch->for_s, shortest_time_s, longest_time_s));
  watch.option("--also", "PARAM,...", also_meaning, list(watch->also));
  watch.option("--csv", "FILE",
               "Write the changes to this file, too; '-': to standard output instead",
               text(watch->csv));
  watch.internal(watch->internal);
}

}  // namespace tmclctl

// capture: what a module records by itself.
#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "command_line/form.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "plot/svg_plot.hpp"
#include "tmcl/api/capture.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/spelling.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
namespace capture = tmcl::api::capture;

// More than any buffer holds.
constexpr double most_captured_samples = 1 << 24;
constexpr tmcl::Duration capture_look_interval = std::chrono::milliseconds(100);
// A journey on the bus is over in seconds at the earliest.
constexpr tmcl::Duration journey_interval = std::chrono::milliseconds(500);

capture::Start params_of(const verb::Capture& verb) {
  capture::Start params{.axis = verb.axis, .channels = verb.channels};
  params.rate_hz = verb.rate_hz;
  params.samples = verb.samples;
  if (verb.for_s && verb.rate_hz)
    params.samples = static_cast<std::int32_t>(
        std::min(std::round(*verb.for_s * *verb.rate_hz), most_captured_samples));
  if (const auto& trigger = verb.trigger) {
    params.trigger_parameter = trigger->parameter;
    params.trigger_edge = trigger->edge;
    params.trigger_value = trigger->value;
  }
  params.pretrigger_percent = verb.pretrigger_percent;
  if (verb.resume) params.resume = true;
  return params;
}

std::string text_of(const verb::Capture::Trigger& trigger) {
  return fmt::format("{} {} {}", trigger.parameter, trigger.edge, trigger.value);
}

/// From the first call to the last value, or to what ends it.
class CaptureRecorder {
 public:
  CaptureRecorder(const verb::Capture& verb, Context& context)
      : verb_(verb), context_(context), line_(context.output) {}

  Result<void> record() {
    auto begun = call(params_of(verb_));
    if (!begun) return tl::unexpected(begun.error());
    started_ = std::move(*begun);
    auto whole = wait();
    if (whole) whole = read();
    line_.clear();
    if (context_.host.signal() != 0) return tl::unexpected(interrupted());
    if (!whole) return tl::unexpected(resumable(whole.error()));
    // What is here is here, whatever becomes of the module.
    (void)call(capture::End{.axis = verb_.axis, .capture = started_.capture});
    return {};
  }

  const capture::Started& started() const { return started_; }
  const std::vector<std::int32_t>& values() const { return values_; }

 private:
  /// Each is short, and a signal does not end it: the module is to be freed afterwards.
  template <class Method>
  Result<typename Method::Result> call(const Method& params) {
    return context_.call(params, {.timeout = {}, .meanwhile = [] {}});
  }
  /// The same again for as long as others are led along a path on that bus.
  template <class Method>
  Result<typename Method::Result> call_beside_journeys(const Method& params) {
    auto result = call(params);
    while (!result && result.error().name == "axis_claimed" && context_.host.signal() == 0) {
      tell("waits: " + result.error().message);
      context_.sleep(journey_interval);
      result = call(params);
    }
    return result;
  }

  Result<void> wait() {
    while (context_.host.signal() == 0) {
      const auto progress =
          call_beside_journeys(capture::GetState{.axis = verb_.axis, .capture = started_.capture});
      if (!progress) return tl::unexpected(progress.error());
      if (progress->state == "complete") return {};
      if (progress->state == "idle" || progress->state == "error")
        return tl::unexpected(lost(progress->state));
      tell_of(progress->state);
      context_.sleep(capture_look_interval);
    }
    return {};
  }

  Result<void> read() {
    const auto all = total();
    const auto begin = context_.host.now();
    while (values_.size() < all && context_.host.signal() == 0) {
      const auto done = values_.size();
      const auto count = std::min<std::size_t>(capture::most_values, all - done);
      auto part = call_beside_journeys(capture::Read{.axis = verb_.axis,
                                                     .capture = started_.capture,
                                                     .first = static_cast<std::int32_t>(done),
                                                     .count = static_cast<std::int32_t>(count)});
      if (!part) return tl::unexpected(part.error());
      if (part->values.empty()) return tl::unexpected(lost("empty"));
      values_.insert(values_.end(), part->values.begin(), part->values.end());
      const std::chrono::duration<double> passed = context_.host.now() - begin;
      const auto left = static_cast<double>(all - values_.size()) /
                        static_cast<double>(values_.size()) * passed.count();
      line_.show(fmt::format("{}: reads {} of {} values, {:.0f} s left", verb_.axis, values_.size(),
                             all, std::ceil(left)));
    }
    return {};
  }

  std::size_t total() const {
    return static_cast<std::size_t>(started_.samples) * started_.channels.size();
  }

  void tell_of(const std::string& state) {
    if (state == "capture") {
      if (!records_since_) records_since_ = context_.host.now();
      const std::chrono::duration<double> passed = context_.host.now() - *records_since_;
      const auto all = (started_.samples - started_.pretrigger) / started_.rate_hz;
      tell(fmt::format("records, {:.0f} s left", std::ceil(std::max(all - passed.count(), 0.0))));
    } else if (state == "pretrigger") {
      tell("records what lies before the trigger");
    } else if (verb_.trigger) {
      const auto value =
          call(api::parameter::Get{{verb_.axis, name_or_number(verb_.trigger->parameter)}});
      const auto now = value ? fmt::format("; it is {} now", value->value) : std::string();
      const auto what = "waits for the trigger: " + text_of(*verb_.trigger) + now;
      tell(what);
      say_once(what);
    }
  }
  void tell(const std::string& what) { line_.show(verb_.axis + ": " + what); }
  /// Where there is no terminal for a line that is drawn again and again.
  void say_once(const std::string& what) {
    if (line_.visible() || has_said_) return;
    has_said_ = true;
    context_.output.err << verb_.axis << ": " << what << " (Ctrl-C ends that)\n" << std::flush;
  }

  Error lost(const std::string& state) const {
    return {"unexpected_value", ErrorKind::failed, tmcl::Outcome::done,
            fmt::format("the module of {} records nothing any more: {}", verb_.axis, state),
            "it has started again, or another client has ended the capture"};
  }
  /// Where the module may still have what it records, whatever else there is to try.
  static Error resumable(Error failure) {
    if (failure.name == "unexpected_value") return failure;
    if (!failure.hint.empty()) failure.hint += ". ";
    failure.hint += "The same command with --resume goes on: the module keeps what it records";
    return failure;
  }
  /// Frees the module.
  Error interrupted() {
    const auto signal = context_.host.take_signal();
    const auto ended = call(capture::End{.axis = verb_.axis, .capture = started_.capture});
    return interrupted_error(
        signal,
        ended ? fmt::format("no longer recording; the module of {} is free", verb_.axis)
              : fmt::format("no longer recording, but the module of {} may be: {}", verb_.axis,
                            ended.error().message),
        "");
  }

  const verb::Capture& verb_;
  Context& context_;
  ProgressLine line_;
  capture::Started started_;
  std::vector<std::int32_t> values_;
  std::optional<tmcl::TimePoint> records_since_;
  bool has_said_ = false;
};

// ---- What came of it

std::string name_of(const capture::Channel& channel) {
  return channel.parameter.value_or(std::to_string(channel.number));
}

/// A column for the time, from the trigger on, and one for each channel.
struct Recording {
  std::vector<std::string> names;
  std::vector<double> times;
  std::vector<std::vector<std::int32_t>> values;  ///< Of each channel.
};

Recording recording_of(const capture::Started& started, const std::vector<std::int32_t>& values) {
  Recording recording;
  for (const auto& channel : started.channels) recording.names.push_back(name_of(channel));
  const auto channels = started.channels.size();
  recording.values.resize(channels);
  for (std::size_t i = 0; i < values.size(); ++i)
    recording.values[i % channels].push_back(values[i]);
  for (std::int32_t i = 0; i < started.samples; ++i)
    recording.times.push_back((i - started.pretrigger) / started.rate_hz);
  return recording;
}

std::string to_csv(const Recording& recording) {
  std::string text = "time_s";
  for (const auto& name : recording.names) text += "," + name;
  for (std::size_t i = 0; i < recording.times.size(); ++i) {
    text += '\n' + tmcl::plain_number(recording.times[i], 6);
    for (const auto& channel : recording.values) text += "," + std::to_string(channel[i]);
  }
  return text + "\n";
}

std::string summary(const verb::Capture& verb, const capture::Started& started) {
  std::string names;
  for (const auto& channel : started.channels)
    names += (names.empty() ? "" : ", ") + name_of(channel);
  return fmt::format("{}: {} samples of {} at {} Hz", verb.axis, started.samples, names,
                     tmcl::plain_number(started.rate_hz, 6));
}

plot::Picture picture_of(const verb::Capture& verb, const capture::Started& started,
                         const Recording& recording) {
  constexpr std::array colours{"position", "velocity", "acceleration", "jerk"};
  plot::Picture picture{summary(verb, started), "s", {}, {}};
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    plot::Curve curve;
    curve.name = recording.names[i];
    curve.unit = started.channels[i].unit.value_or("internal");
    curve.times = recording.times;
    curve.values.assign(recording.values[i].begin(), recording.values[i].end());
    curve.colour_of = colours.at(i % colours.size());
    picture.curves.push_back(std::move(curve));
  }
  if (verb.trigger) picture.marks.push_back({0, text_of(*verb.trigger)});
  return picture;
}

json::value or_null(const std::string& text) {
  return text.empty() ? json::value(nullptr) : json::value(text);
}

json::object to_json(const verb::Capture& verb, const capture::Started& started,
                     const Recording& recording) {
  json::array channels;
  for (std::size_t i = 0; i < recording.names.size(); ++i) {
    auto channel = api::to_json(started.channels[i]);
    const auto& values = recording.values[i];
    channel["values"] = json::array(values.begin(), values.end());
    channels.push_back(std::move(channel));
  }
  return {{"axis", verb.axis},
          {"rate_hz", started.rate_hz},
          {"pretrigger", started.pretrigger},
          {"time_s", json::array(recording.times.begin(), recording.times.end())},
          {"channels", std::move(channels)},
          {"svg", or_null(verb.svg)},
          {"csv", or_null(verb.csv)}};
}

void show(const verb::Capture& verb, const capture::Started& started, const Recording& recording,
          Output& output) {
  const bool has_file = !verb.svg.empty() || (!verb.csv.empty() && verb.csv != "-");
  if (output.json) {
    print_json(to_json(verb, started, recording), output);
  } else if (!has_file || verb.csv == "-") {
    output.out << to_csv(recording);
  } else {
    output.out << summary(verb, started) << '\n';
  }
}

Result<ExitCode> run(const verb::Capture& verb, Context& context) {
  OutputFile svg;
  OutputFile csv;
  if (auto opened = svg.open(verb.svg); !opened) return tl::unexpected(opened.error());
  if (auto opened = csv.open(verb.csv == "-" ? "" : verb.csv); !opened)
    return tl::unexpected(opened.error());
  CaptureRecorder recorder(verb, context);
  if (auto recorded = recorder.record(); !recorded) return tl::unexpected(recorded.error());
  const auto& started = recorder.started();
  const auto recording = recording_of(started, recorder.values());
  if (auto written = svg.write(plot::to_svg(picture_of(verb, started, recording))); !written)
    return tl::unexpected(written.error());
  if (auto written = csv.write(to_csv(recording)); !written) return tl::unexpected(written.error());
  show(verb, started, recording, context.output);
  return ExitCode::done;
}

// More than any buffer holds.
constexpr std::int32_t most_samples = 1 << 24;

Reading read_rate(const std::string& text, std::optional<double>& rate_hz) {
  constexpr double kilo = 1000;
  std::string_view digits = text;
  if (digits.ends_with("Hz")) digits.remove_suffix(2);
  const bool thousands = digits.ends_with("k") && digits.size() + 2 == text.size();
  if (thousands) digits.remove_suffix(1);
  while (digits.ends_with(" ")) digits.remove_suffix(1);
  return parse_number<double>(digits, 0)
      .map([&](double value) { rate_hz = thousands ? value * kilo : value; })
      .map_error(
          [&](const std::string&) { return "'" + text + "' is no rate such as 500Hz or 1kHz"; });
}

Reading read_percent(const std::string& text, std::optional<std::int32_t>& percent) {
  std::string_view digits = text;
  if (digits.ends_with('%')) digits.remove_suffix(1);
  return parse_number<std::int32_t>(digits, 0, 100).map([&](std::int32_t value) {
    percent = value;
  });
}

// PARAMETER EDGE VALUE
Reading read_trigger(const std::string& text, std::optional<verb::Capture::Trigger>& trigger) {
  verb::Capture::Trigger said;
  std::istringstream words(text);
  std::string value;
  std::string rest;
  const std::string form = " is no trigger such as 'actual_velocity rising 100'";
  if (!(words >> said.parameter >> said.edge >> value) || words >> rest)
    return tl::unexpected("'" + text + "'" + form);
  constexpr auto edges = std::to_array<std::string_view>({"rising", "falling", "both"});
  if (std::ranges::find(edges, said.edge) == edges.end()) {
    return tl::unexpected("'" + said.edge + "' is no edge: rising, falling or both." +
                          tmcl::did_you_mean(said.edge, edges));
  }
  return parse_number<std::int32_t>(value).map([&](std::int32_t number) {
    said.value = number;
    trigger = said;
  });
}

constexpr const char* capture_help = R"(
Has the module record parameters of the axis at the ticks of its own clock (command 142, RAMDebug),
many times faster than a bus could ask for them, and reads the recording afterwards: as CSV, with the
time from the trigger on, and values as the module counts them. Few modules have this, and no manual
says which.

--rate is the module's own rate or a whole part of it; without --samples or --for the recording
fills the module's buffer. Reading takes about 2 ms for each value at 115200 baud; others use the bus
meanwhile, and while axes of that bus are led along a path, this waits.

Ctrl-C ends the recording and frees the module. What an error ends, such as a lost connection, is
taken up again by the same command with --resume.

  tmclctl capture x --channel actual_position --channel actual_velocity --samples 1000
  tmclctl capture x --channel actual_velocity --rate 500Hz --for 4 --csv start.csv
  tmclctl capture x --channel actual_position --channel actual_velocity --rate 1kHz \
      --trigger 'actual_velocity rising 100' --pretrigger 20% --svg start.svg
)";

}  // namespace

void add_capture(Grammar& grammar) {
  auto capture = grammar.verb<verb::Capture>("capture", access::acts,
                                             "Have the module record parameters at its own ticks",
                                             capture_help, run);
  capture.axis(capture->axis);
  auto& values = *capture.operator->();
  capture.repeated_option("--channel", "PARAM", "Record this axis parameter; may be given again",
                          texts(values.channels));
  capture.option("--rate", "RATE", "So many samples a second, such as 500Hz or 1kHz",
                 [&values](const std::string& text) { return read_rate(text, values.rate_hz); });
  capture.option("--samples", "N", "Record so many of each channel",
                 number(values.samples, 1, most_samples));
  capture.option("--for", "SECONDS", "Record for so long; needs --rate",
                 number(values.for_s, shortest_time_s, longest_time_s));
  capture.option("--trigger", "'PARAM EDGE VALUE'",
                 "Begin when the parameter passes the value: rising, falling or both",
                 [&values](const std::string& text) { return read_trigger(text, values.trigger); });
  capture.option(
      "--pretrigger", "PERCENT", "So much of the recording lies before the trigger",
      [&values](const std::string& text) { return read_percent(text, values.pretrigger_percent); });
  capture.option("--svg", "FILE", "Write a drawing to this file", svg_file(values.svg));
  capture.option("--csv", "FILE", "Write the samples to this file; '-': to standard output",
                 text(values.csv));
  capture.flag("--resume", "Read what the module records, or has recorded, already", values.resume);
  capture.object([](const verb::Capture& said, bool json) {
    if (said.channels.empty()) return "say what to record: --channel PARAM";
    if (said.for_s && said.samples) return "--for and --samples exclude each other";
    if (said.for_s && !said.rate_hz) return "--for needs --rate";
    if (said.pretrigger_percent && !said.trigger) return "--pretrigger needs --trigger";
    return json && said.csv == "-" ? "--json and '--csv -' both want standard output" : "";
  });
}

}  // namespace tmclctl

// watch
#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

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
     "link_restored", "link_condition"});

/// What is told of an axis, but for how old it is.
boost::json::object news_of(AxisReading reading) {
  reading.age_ms = 0;
  return api::to_json<api::axis::State>(reading);
}

std::string motion_text(const AxisReading& reading) {
  if (reading.moving) return "moving";
  if (reading.position_reached) return "at target";
  return reading.stop_cause ? "stopped: " + *reading.stop_cause : "standing";
}

std::string condition_text(const AxisReading& reading) {
  const auto faults = joined(reading.faults);
  return motion_text(reading) + (faults.empty() ? "" : "  FAULT: " + faults);
}

/// Prints what is told of axes, and says for how long that is wanted.
class Watching {
 public:
  Watching(const verb::Watch& verb, Context& context)
      : verb_(verb), output_(context.output), host_(context.host), begin_(context.host.now()) {}

  AxesWatcher watcher() {
    return {
        .on_reading = [this](const auto& axis, const auto& reading) { tell(axis, reading); },
        .on_error =
            [this](const auto& axis, const auto& failure) {
              tell("failed", axis + ": " + with_verbs(failure.message), error_document(failure));
            },
        .on_event = [this](const auto& event) { tell(event); },
        .wanted =
            [this] { return host_.signal() == 0 && !(verb_.for_s && passed_s() >= *verb_.for_s); }};
  }
  void tell_away(const Error* why) {
    if (why == nullptr) return tell("away", "tmcld is there again", nullptr);
    tell("away", with_verbs(why->message), error_document(*why));
  }

 private:
  double passed_s() const { return std::chrono::duration<double>(host_.now() - begin_).count(); }
  void tell(const std::string& axis, const AxisReading& reading);
  void tell(const api::Event& event);
  /// What is no reading; `key` is what its document has it under.
  void tell(std::string_view key, const std::string& text, boost::json::value document);

  const verb::Watch& verb_;
  Output& output_;
  Host& host_;
  tmcl::TimePoint begin_;
  std::map<std::string, boost::json::object> last_;
};

void Watching::tell(const std::string& axis, const AxisReading& reading) {
  auto& last = last_[axis];
  if (auto news = news_of(reading); news != last) {
    last = std::move(news);
  } else {
    return;
  }
  if (output_.json) {
    auto document = api::to_json<api::axis::State>(reading);
    document["time_s"] = passed_s();
    document["utc"] = tmcl::to_text(host_.utc());
    return print_json(document, output_);
  }
  output_.out << fmt::format("{:9.3f} s  {}  position {}  velocity {}  target {}  {}", passed_s(),
                             axis, position_text(reading, verb_.internal),
                             velocity_text(reading, verb_.internal),
                             target_text(reading, verb_.internal), condition_text(reading))
              << std::endl;
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
  output_.out << fmt::format("{:9.3f} s  {}", passed_s(), text) << std::endl;
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
  return keep_watching(
             axes, verb.interval, watching.watcher(),
             [&](const Error* why) { watching.tell_away(why); }, context)
      .map([] { return ExitCode::done; });
}

constexpr const char* watch_help = R"(
One line for each change of some axes or of all, until Ctrl-C (exit code 0) or the end of --for, in the
unit of the axis if it has one. With --json, one document a line. It stays while modules do not answer, a
bus is lost or tmcld starts again, and says so; documents of that have "event" or "away" instead of "axis".

  tmclctl watch x
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
      [](const verb::Watch& said, bool) {
        return said.axes.empty() != said.all ? "name one AXIS or more, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
  auto& interval = watch->interval;
  watch.option("--interval", "MS", "At most one line in so many milliseconds (default 100)",
               milliseconds(interval));
  watch.option("--for", "SECONDS", "End after so long",
               number(watch->for_s, shortest_time_s, longest_time_s));
  watch.internal(watch->internal);
}

}  // namespace tmclctl

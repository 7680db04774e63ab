// Everything that is said of axes.
#include <algorithm>
#include <array>
#include <sstream>

#include "grammar.hpp"
#include "help_text.hpp"
#include "tmcl/spelling.hpp"

namespace tmclctl {
namespace {

constexpr double longest_line_s = 86'400;
constexpr double shortest_load_s = 0.1;
constexpr double shortest_ttl_s = 0.2;
constexpr double longest_ttl_s = 60;
constexpr int shortest_interval_ms = 10;
constexpr int longest_interval_ms = 60'000;
// Of what bus.trace gives at once.
constexpr std::int32_t most_remembered = 1024;
// More than any buffer holds.
constexpr std::int32_t most_samples = 1 << 24;

tl::expected<void, std::string> read_range(const std::string& text, ScanRange& range) {
  const auto dash = text.find('-');
  const auto first = text.substr(0, dash);
  const auto last = dash == std::string::npos ? first : text.substr(dash + 1);
  return number(range.first, 0, greatest_address)(first).and_then(
      [&] { return number(range.last, range.first, greatest_address)(last); });
}

tl::expected<void, std::string> read_interval(const std::string& text,
                                              std::chrono::milliseconds& interval) {
  return parse_number<int>(text, shortest_interval_ms, longest_interval_ms).map([&](int value) {
    interval = std::chrono::milliseconds(value);
  });
}

tl::expected<void, std::string> read_goal(const std::string& text,
                                          std::vector<verb::Line::Goal>& goals) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    return tl::unexpected("'" + text + "' is no AXIS=POSITION");
  goals.push_back({text.substr(0, equals), text.substr(equals + 1)});
  return {};
}

tl::expected<void, std::string> read_rate(const std::string& text, std::optional<double>& rate_hz) {
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

tl::expected<void, std::string> read_percent(const std::string& text,
                                             std::optional<std::int32_t>& percent) {
  std::string_view digits = text;
  if (digits.ends_with('%')) digits.remove_suffix(1);
  return parse_number<std::int32_t>(digits, 0, 100).map([&](std::int32_t value) {
    percent = value;
  });
}

// PARAMETER EDGE VALUE
tl::expected<void, std::string> read_trigger(const std::string& text,
                                             std::optional<verb::Capture::Trigger>& trigger) {
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

}  // namespace

void add_lists(Grammar& grammar) {
  grammar.verb<verb::Ports>("ports", "List the serial ports and modules by USB of this computer",
                            help_text::ports);
  auto scan =
      grammar.verb<verb::Scan>("scan", "Look for modules on all addresses", help_text::scan);
  auto& range = scan->range;
  scan.option("--addresses", "FIRST-LAST", "Only these addresses (default 1-255)",
              [&range](const std::string& text) { return read_range(text, range); });
  grammar.verb<verb::Modules>("modules", "List the modules that tmcld serves", help_text::modules);
  grammar.verb<verb::Axes>("axes", "List the axes and how they are called", help_text::axes);
  auto params = grammar.verb<verb::Params>("params", "List the parameters of an axis or a model",
                                           help_text::params);
  params.optional_word("AXIS", axis_meaning, text(params->axis));
  params.flag("--values", "Read them all, too", params->values);
  params.internal(params->internal);
  params.option("--model", "MODEL", "Of this model, without any module", text(params->model));
  params.flag("--globals", "With --model: the global parameters", params->globals);
  params.object([](const verb::Params& said, bool) {
    if (said.axis.empty() == said.model.empty()) return "name an axis, or say --model MODEL";
    if (said.model.empty()) return said.globals ? "--globals needs --model" : "";
    return said.values ? "--values needs an axis to read from" : "";
  });
  grammar.verb<verb::Models>("models", "List the models that are known", help_text::models);
}

void add_parameters(Grammar& grammar) {
  auto get =
      grammar.verb<verb::Get>("get", "Read a parameter: prints one bare number", help_text::get);
  get.axis(get->axis);
  get.word("PARAM", "Number or standard name", text(get->parameter));
  get.flag("--in-units", "Print it with the unit of the axis, or in turns if it has none",
           get->in_units);
  auto set = grammar.verb<verb::Set>("set", "Set a parameter", help_text::set);
  set.axis(set->axis);
  set.word("PARAM", "Number or standard name", text(set->parameter));
  set.word(
      "VALUE",
      "The new value, as the module counts; positions, velocities and accelerations may have units",
      text(set->value));
}

void add_motion(Grammar& grammar) {
  auto move =
      grammar.verb<verb::Move>("move", "Move to a position, or by a distance", help_text::move);
  move.axis(move->axis);
  move.word("POSITION", "Where to go, with a unit; may be negative", text(move->position));
  move.flag("--by", "POSITION is the distance from where the axis is now", move->by);
  move.flag("--wait", "Wait until the axis stands at its target", move->wait);
  move.option("--timeout", "SECONDS", "With --wait: give up after so long; the axis goes on",
              number(move->timeout_s, shortest_time_s, longest_time_s));
  move.internal(move->internal);
  move.object([](const verb::Move& said, bool) {
    return said.timeout_s && !said.wait ? "--timeout says how long to wait, and that needs --wait"
                                        : "";
  });
  auto wait =
      grammar.verb<verb::Wait>("wait", "Wait until axes stand at their targets", help_text::wait);
  wait.words("AXIS", axis_meaning,
             [&axes = wait->axes](const std::string& text) -> tl::expected<void, std::string> {
               axes.push_back(text);
               return {};
             });
  wait.option("--timeout", "SECONDS", "Give up after so long; the axes go on",
              number(wait->timeout_s, shortest_time_s, longest_time_s));
  wait.internal(wait->internal);
  wait.object([](const verb::Wait& said, bool) {
    return said.axes.empty() ? "name at least one AXIS" : "";
  });
  auto line = grammar.verb<verb::Line>("line", "Move several axes together along a straight line",
                                       help_text::line);
  line.words("AXIS=POSITION", "Where each of them is to go, with a unit",
             [&goals = line->goals](const std::string& text) { return read_goal(text, goals); });
  line.option("--velocity", "VELOCITY", "What no axis exceeds, such as 20mm/s or 50000pps",
              text(line->velocity));
  line.option("--acceleration", "ACCELERATION", "Likewise, such as 100mm/s^2 or 200000pps/s",
              text(line->acceleration));
  line.option("--time", "SECONDS", "Take so long; without it, as short as possible",
              number(line->time_s, shortest_time_s, longest_line_s));
  line.flag("--wait", "Wait until all of them stand at their targets", line->wait);
  line.option("--timeout", "SECONDS", "With --wait: give up after so long; the axes go on",
              number(line->timeout_s, shortest_time_s, longest_time_s));
  line.internal(line->internal);
  line.object([](const verb::Line& said, bool) {
    if (said.goals.empty()) return "name at least one AXIS=POSITION";
    return said.timeout_s && !said.wait ? "--timeout says how long to wait, and that needs --wait"
                                        : "";
  });
  auto rotate = grammar.verb<verb::Rotate>("rotate", "Turn without end", help_text::rotate);
  rotate.axis(rotate->axis);
  rotate.word("VELOCITY", "With a unit; negative: to the left", text(rotate->velocity));
  rotate.flag("--unattended", "Come back at once, and let it turn without anybody who watches it",
              rotate->unattended);
  rotate.internal(rotate->internal);
  auto stop = grammar.verb<verb::Stop>("stop", "Stop an axis, or all of them", help_text::stop);
  stop.optional_word("AXIS", axis_meaning, text(stop->axis));
  stop.flag("--all", "Every axis there is", stop->all);
  stop.object(
      [](const verb::Stop& said, bool) {
        return said.axis.empty() != said.all ? "name one axis, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
}

void add_leases(Grammar& grammar) {
  const auto group =
      grammar.group("lease", "The right of one program alone to move axes", help_text::lease);
  auto run = grammar.verb<verb::RunLeased>(
      group, "run", "Run a program that has axes for itself: AXIS... -- COMMAND...",
      help_text::lease);
  run.words("AXIS", axis_meaning,
            [&axes = run->axes](const std::string& text) -> tl::expected<void, std::string> {
              axes.push_back(text);
              return {};
            });
  run.option("--ttl", "SECONDS",
             "The axes stop so long after this program has been lost (default 2)",
             number(run->ttl_s, shortest_ttl_s, longest_ttl_s));
  run.object([](const verb::RunLeased& said, bool) {
    return said.axes.empty() ? "name at least one AXIS" : "";
  });
  grammar.verb<verb::Leases>(group, "list", "Who has which axes", help_text::lease);
  auto breaks = grammar.verb<verb::BreakLease>(
      group, "break", "Take the lease of an axis away; it is stopped", help_text::lease);
  breaks.axis(breaks->axis);
}

void add_tokens(Grammar& grammar) {
  const auto group =
      grammar.group("token", "What lets clients in from the network", help_text::token);
  auto add = grammar.verb<verb::AddToken>(group, "add", "Make one and print it, this once",
                                          help_text::token);
  add.required_option("--role", "ROLE", "What it lets do: observe, operate or configure",
                      text(add->role));
  add.option("--name", "NAME", "What it is called; token-1 or the next without", text(add->name));
  grammar.verb<verb::Tokens>(group, "list", "Which there are", help_text::token);
  auto revoke = grammar.verb<verb::RevokeToken>(
      group, "revoke", "Let nobody in by it any more, and end who is", help_text::token);
  revoke.word("NAME", "As list has it", text(revoke->name));
}

void add_watch(Grammar& grammar) {
  auto state = grammar.verb<verb::State>("state", "Show where an axis is and what it does",
                                         help_text::state);
  state.axis(state->axis);
  state.internal(state->internal);
  auto watch = grammar.verb<verb::Watch>("watch", "Show every change of axes", help_text::watch);
  watch.words("AXIS", axis_meaning,
              [&axes = watch->axes](const std::string& text) -> tl::expected<void, std::string> {
                axes.push_back(text);
                return {};
              });
  watch.flag("--all", "Every axis there is", watch->all);
  watch.object(
      [](const verb::Watch& said, bool) {
        return said.axes.empty() != said.all ? "name one AXIS or more, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
  auto& interval = watch->interval;
  watch.option("--interval", "MS", "At most one line in so many milliseconds (default 100)",
               [&interval](const std::string& text) { return read_interval(text, interval); });
  watch.option("--for", "SECONDS", "End after so long",
               number(watch->for_s, shortest_time_s, longest_time_s));
  watch.internal(watch->internal);
  auto top = grammar.verb<verb::Top>("top", "Show all axes on the whole terminal", help_text::top);
  auto& top_interval = top->interval;
  top.option(
      "--interval", "MS", "Draw at most once in so many milliseconds (default 200)",
      [&top_interval](const std::string& text) { return read_interval(text, top_interval); });
  top.internal(top->internal);
  auto buses = grammar.verb<verb::Buses>("buses", "Show the buses, their load and what went wrong",
                                         help_text::buses);
  buses.option("--for", "SECONDS", "Measure the load for so long (default 1)",
               number(buses->for_s, shortest_load_s, longest_time_s));
}

void add_trace(Grammar& grammar) {
  auto trace = grammar.verb<verb::Trace>("trace", "Show what goes over a bus", help_text::trace);
  trace.optional_word("BUS", "Its name; not needed where there is one", text(trace->bus));
  trace.option("--last", "N", "Begin with the last N datagrams that tmcld remembers",
               number(trace->last, 1, most_remembered));
  trace.option("--for", "SECONDS", "End after so long",
               number(trace->for_s, shortest_time_s, longest_time_s));
  trace.option("-w,--write", "FILE", "Write a file for Wireshark instead; '-': to standard output",
               text(trace->file));
  trace.option("-r,--read", "FILE", "Show what is in such a file", text(trace->read));
  trace.object(
      [](const verb::Trace& said, bool) {
        const bool more = !said.bus.empty() || !said.file.empty() || said.last || said.for_s;
        return !said.read.empty() && more ? "--read takes nothing beside it" : "";
      },
      "'tmclctl trace --read FILE'");
}

void add_plot(Grammar& grammar) {
  auto plot = grammar.verb<verb::Plot>("plot", "Record a movement and draw position and velocity",
                                       help_text::plot);
  plot.axis(plot->axis);
  plot.option("--to", "POSITION", "Start a move to this position", text(plot->to));
  plot.option("--by", "DISTANCE", "Start a move by this distance", text(plot->by));
  plot.option("--for", "SECONDS", "Record for so long at most",
              number(plot->for_s, shortest_time_s, longest_time_s));
  plot.option("--svg", "FILE", "Write the drawing to this file, too", svg_file(plot->svg));
  plot.option("--csv", "FILE",
              "Write the samples to this file, too; '-': to standard output instead",
              text(plot->csv));
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

void add_capture(Grammar& grammar) {
  auto capture = grammar.verb<verb::Capture>(
      "capture", "Have the module record parameters at its own ticks", help_text::capture);
  capture.axis(capture->axis);
  auto& values = *capture.operator->();
  capture.repeated_option("--channel", "PARAM", "Record this axis parameter; may be given again",
                          [&values](const std::string& text) -> tl::expected<void, std::string> {
                            values.channels.push_back(text);
                            return {};
                          });
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

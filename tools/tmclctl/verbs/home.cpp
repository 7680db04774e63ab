// home.
#include <algorithm>
#include <array>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "axis/arrival_wait.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/api/system.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;

std::string how_to_end(const verb::Home& verb, const Context& context) {
  return fmt::format("End it with: tmclctl{} home {} --stop", context.output.gateway, verb.axis);
}

Error explained(Error failure, const verb::Home& verb, Context& context) {
  if (context.host.signal() != 0) {
    return interrupted_error(
        context.host.signal(),
        fmt::format("no longer waiting; {} goes on searching its reference", verb.axis),
        how_to_end(verb, context));
  }
  if (failure.name != name_of(tmcl::Errc::deadline_passed)) return failure;
  failure.kind = ErrorKind::ended_early;
  failure.name = "timeout";
  if (verb.leave) failure.hint = "The motor goes on searching. " + how_to_end(verb, context);
  return failure;
}

// Nothing for a module that does not tell.
std::optional<std::string> length_text(const std::optional<std::int32_t>& microsteps,
                                       const std::optional<double>& in_unit,
                                       const api::axis::HomedAxis& homed, bool internal) {
  if (!microsteps) return std::nullopt;
  if (!in_unit || internal) return fmt::format("{} microsteps", *microsteps);
  return shown(InUnit{*in_unit, homed.unit.value_or("")}, *microsteps);
}

void print(const api::axis::HomedAxis& homed, const verb::Home& verb, std::ostream& out) {
  out << fmt::format("{} stands at its reference\n", verb.axis);
  if (const auto correction =
          length_text(homed.correction_microsteps, homed.correction, homed, verb.internal))
    out << fmt::format("zero was at {} before\n", *correction);
  if (const auto distance = length_text(homed.switch_distance_microsteps, homed.switch_distance,
                                        homed, verb.internal))
    out << fmt::format("{} between the end switches\n", *distance);
}

template <class Answer>
void print_document(const std::string& axis, const Answer& answer, Output& output) {
  auto document = api::to_json(answer);
  document["axis"] = axis;
  print_json(document, output);
}

Result<ExitCode> end_search(const verb::Home& verb, Context& context) {
  const auto ended = context.call(api::axis::StopHome{verb.axis});
  if (!ended) return tl::unexpected(ended.error());
  if (context.output.json) {
    print_document(verb.axis, *ended, context.output);
  } else {
    context.output.out << verb.axis << " searches no longer\n";
  }
  return ExitCode::done;
}

// ---- how it searches

struct ModeWord {
  std::string_view word;
  std::int32_t mode;
};
/// Of parameter 193, as firmware manuals describe it. 64: the sides are exchanged.
constexpr auto mode_words = std::to_array<ModeWord>({
    {"left", 1},
    {"right-left", 2},
    {"right-left-both", 3},
    {"left-both", 4},
    {"home-negative", 5},
    {"home-positive", 6},
    {"home-positive-only", 7},
    {"home-negative-only", 8},
    {"right", 65},
    {"left-right", 66},
    {"left-right-both", 67},
    {"right-both", 68},
});
/// On modules that have no more, 3 is another search.
constexpr std::int32_t modes_of_old_firmware = 3;
constexpr std::int32_t greatest_mode = 255;
constexpr auto mode_parameter = "reference_search_mode";

std::optional<std::int32_t> greatest_mode_of(const std::string& axis, Context& context) {
  const auto listed = context.call(api::parameter::List{axis});
  if (!listed) return std::nullopt;
  const auto& rows = listed->parameters;
  const auto row = std::ranges::find(rows, mode_parameter, &api::parameter::Parameter::name);
  return row == rows.end() ? std::nullopt : std::optional(row->maximum);
}

/// Nothing: as it is set.
Result<std::optional<std::int32_t>> mode_of(const verb::Home& verb, Context& context) {
  using Mode = std::optional<std::int32_t>;
  if (verb.mode.empty()) return Mode();
  const auto word = std::ranges::find(mode_words, verb.mode, &ModeWord::word);
  if (word == mode_words.end()) return Mode(std::atoi(verb.mode.c_str()));
  const auto greatest = greatest_mode_of(verb.axis, context);
  const bool is_old = greatest && *greatest <= modes_of_old_firmware;
  if (!is_old || word->mode < modes_of_old_firmware) return Mode(word->mode);
  return tl::unexpected(usage_error(
      "out_of_range", fmt::format("the module of {} has no mode '{}'", verb.axis, verb.mode),
      "it has left, right-left, and 3, which searches by all three switches"));
}

Reading read_mode(const std::string& text, std::string& into) {
  into = text;
  if (std::ranges::count(mode_words, text, &ModeWord::word) > 0) return {};
  std::int32_t mode = 0;
  if (number(mode, 1, greatest_mode)(text)) return {};
  std::vector<std::string_view> words;
  for (const auto& one : mode_words) words.push_back(one.word);
  return tl::unexpected(
      fmt::format("'{}' is no mode: a number 1..255, or one of {}", text, fmt::join(words, ", ")));
}

// ---- and ends

Result<ExitCode> start_search(const verb::Home& verb, const Typed& travel, Context& context) {
  const auto mode = mode_of(verb, context);
  if (!mode) return tl::unexpected(mode.error());
  const auto started =
      context.call(api::axis::StartHome{verb.axis, *mode, travel.counted(), travel.amount()});
  if (!started) return tl::unexpected(started.error());
  warn(started->warnings, context.output);
  if (context.output.json) {
    print_document(verb.axis, *started, context.output);
  } else {
    context.output.out << fmt::format("{} searches its reference. {}\n", verb.axis,
                                      how_to_end(verb, context));
  }
  return ExitCode::done;
}

Result<api::axis::HomedAxis> search(const verb::Home& verb, api::axis::Home params,
                                    Context& context) {
  constexpr double milliseconds = 1000;
  if (verb.timeout_s) params.timeout_ms = static_cast<std::int64_t>(*verb.timeout_s * milliseconds);
  if (verb.leave) params.leave = true;
  ProgressLine line(context.output);
  const tmcl::client::Hearing<api::SearchProgress> hearing(
      context.gateway.caller, api::progress_notification, [&](const api::SearchProgress& news) {
        line.show(fmt::format("{} searches its reference, step {}", verb.axis, news.step));
      });
  return context.call(params);
}

Result<ExitCode> run_on_axis(const verb::Home& verb, Context& context) {
  if (verb.stop) return end_search(verb, context);
  const Typed travel{verb.max_travel, verb.internal};
  if (verb.no_wait) return start_search(verb, travel, context);
  const auto mode = mode_of(verb, context);
  if (!mode) return tl::unexpected(mode.error());
  const auto homed =
      search(verb, {verb.axis, *mode, {}, travel.counted(), travel.amount()}, context);
  if (!homed) return tl::unexpected(explained(homed.error(), verb, context));
  warn(homed->warnings, context.output);
  if (context.output.json) {
    print_document(verb.axis, *homed, context.output);
  } else {
    print(*homed, verb, context.output.out);
  }
  return ExitCode::done;
}

/// One axis after the other; the first that fails ends it.
Result<ExitCode> run(const verb::Home& verb, Context& context) {
  auto exit = ExitCode::done;
  for (const auto& axis : verb.axes) {
    auto one = verb;
    one.axis = axis;
    const auto done = run_on_axis(one, context);
    if (!done) return done;
    exit = std::max(exit, *done);
  }
  return exit;
}

constexpr const char* home_help = R"(
Waits until the module says that its search has ended, unless --no-wait is given. Ctrl-C ends the
waiting and NOT the search; 'tmclctl home x --stop' or 'tmclctl stop x' ends that. A search that
another program ends has found nothing, and is told so.

A search whose switch is dead goes on for ever. So it is stopped (exit code 5, cause search_limit)
where it goes further one way, without turning, than --max-travel says, else 'home_max_travel' in the
configuration, else the length of its soft limits and a tenth. Where none of them is given nothing
bounds it, and a warning says so. With --direct --no-wait nothing watches it when tmclctl has ended.

--timeout stops the search, too; with --leave it goes on.

--mode is a number (parameter 193) or a word: left (the left switch), right-left (the right one, then the
left one), left-both (the middle of the left one), right-left-both, home-negative and home-positive (the
home switch, turning at an end switch), home-negative-only and home-positive-only (without end switches);
right, left-right, right-both and left-right-both are the same with the sides exchanged.

  tmclctl home x
  tmclctl home x --max-travel 120mm
  tmclctl home z x y                             one after the other, in this order
  tmclctl home x --mode 5 --timeout 60
  tmclctl home x --mode left
  tmclctl home x --stop
)";

}  // namespace

void add_home(Grammar& grammar) {
  auto home = grammar.verb<verb::Home>("home", access::acts, "Search the reference position",
                                       home_help, run);
  home.words("AXIS", axis_meaning, texts(home->axes));
  auto& values = *home.operator->();
  home.option("--mode", "MODE", "Which switches are searched how: a word, or parameter 193",
              [&values](const std::string& said) { return read_mode(said, values.mode); });
  home.option("--max-travel", "WAY",
              "Stop the search where it goes further one way, such as 120mm or 3rev",
              text(home->max_travel));
  home.option("--timeout", "SECONDS", "Stop the search after so long, and give up",
              number(home->timeout_s, shortest_time_s, longest_time_s));
  home.flag("--leave", "Let the search go on after --timeout", home->leave);
  home.flag("--no-wait", "Come back as soon as the search has begun", home->no_wait);
  home.flag("--stop", "End a search", home->stop);
  home.internal(home->internal);
  home.object([](const verb::Home& said, bool) {
    if (said.axes.empty()) return "name an axis";
    if (said.stop && (!said.mode.empty() || said.timeout_s || said.no_wait ||
                      !said.max_travel.empty() || said.leave))
      return "--stop goes with no other option";
    if (said.leave && !said.timeout_s)
      return "--leave says what becomes of the search after --timeout: give that, too";
    return said.no_wait && said.timeout_s ? "--no-wait and --timeout exclude each other" : "";
  });
}

}  // namespace tmclctl

// home.
#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"
#include "tmcl/api/system.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;

std::string how_to_end(const verb::Home& verb, const Context& context) {
  return fmt::format("End it with: tmclctl{} home {} --stop", context.gateway.options, verb.axis);
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

Result<ExitCode> start_search(const verb::Home& verb, const Typed& travel, Context& context) {
  const auto started =
      context.call(api::axis::StartHome{verb.axis, verb.mode, travel.counted(), travel.amount()});
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

Result<ExitCode> run(const verb::Home& verb, Context& context) {
  if (verb.stop) return end_search(verb, context);
  const Typed travel{verb.max_travel, verb.internal};
  if (verb.no_wait) return start_search(verb, travel, context);
  const auto homed =
      search(verb, {verb.axis, verb.mode, {}, travel.counted(), travel.amount()}, context);
  if (!homed) return tl::unexpected(explained(homed.error(), verb, context));
  warn(homed->warnings, context.output);
  if (context.output.json) {
    print_document(verb.axis, *homed, context.output);
  } else {
    print(*homed, verb, context.output.out);
  }
  return ExitCode::done;
}

constexpr std::int32_t greatest_mode = 255;

constexpr const char* home_help = R"(
Waits until the module says that its search has ended, unless --no-wait is given. Ctrl-C ends the
waiting and NOT the search; 'tmclctl home x --stop' or 'tmclctl stop x' ends that. A search that
another program ends has found nothing, and is told so.

A search whose switch is dead goes on for ever. So it is stopped (exit code 5, cause search_limit)
where it goes further one way, without turning, than --max-travel says, else 'home_max_travel' in the
configuration, else the length of its soft limits and a tenth. Where none of them is given nothing
bounds it, and a warning says so. With --direct --no-wait nothing watches it when tmclctl has ended.

--timeout stops the search, too; with --leave it goes on.

  tmclctl home x
  tmclctl home x --max-travel 120mm
  tmclctl home x --mode 5 --timeout 60
  tmclctl home x --stop
)";

}  // namespace

void add_home(Grammar& grammar) {
  auto home = grammar.verb<verb::Home>("home", access::acts, "Search the reference position",
                                       home_help, run);
  home.axis(home->axis);
  home.option("--mode", "N", "Which switches are searched how (parameter 193)",
              number(home->mode, 1, greatest_mode));
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
    if (said.stop &&
        (said.mode || said.timeout_s || said.no_wait || !said.max_travel.empty() || said.leave))
      return "--stop goes with no other option";
    if (said.leave && !said.timeout_s)
      return "--leave says what becomes of the search after --timeout: give that, too";
    return said.no_wait && said.timeout_s ? "--no-wait and --timeout exclude each other" : "";
  });
}

}  // namespace tmclctl

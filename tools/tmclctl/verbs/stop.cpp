// stop.
#include <algorithm>
#include <cctype>
#include <iterator>

#include <fmt/format.h>

#include "axis/arrival_wait.hpp"
#include "fleet/fleet_verbs.hpp"
#include "output/print.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// Modules are numbered from 1 upwards, so the first of them are told to stop before the rest has
// been looked for.
constexpr std::uint16_t stop_scan_step = 16;
constexpr std::uint16_t stop_scan_last = 255;

bool is_all(std::string word) {
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word == "all";
}

Error stopped_nothing(Error failure) {
  auto& hint = failure.hint;
  if (!hint.empty()) hint[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(hint[0])));
  hint = std::string(everything_moves) + hint;
  return failure;
}

struct StoppedAxis {
  std::string axis;
  std::optional<double> milliseconds;
  std::optional<Error> error;
};

std::vector<StoppedAxis> stop_motors(const ModuleRow& module, Context& context) {
  std::vector<StoppedAxis> stopped;
  for (std::uint8_t motor = 0; motor < module.axes; ++motor) {
    StoppedAxis row{axis_name({tmcl::ModuleAddress{module.address}, motor}), {}, {}};
    const auto before = context.host.now();
    const auto result = context.call(api::axis::Stop{row.axis});
    const std::chrono::duration<double, std::milli> took = context.host.now() - before;
    if (result) {
      row.milliseconds = took.count();
    } else {
      row.error = result.error();
    }
    stopped.push_back(std::move(row));
  }
  return stopped;
}

/// A program that runs in the module is ended behind its motors, which are then stopped once more.
std::vector<StoppedAxis> stop_module(const ModuleRow& module, Context& context) {
  auto stopped = stop_motors(module, context);
  const api::OnModule place{module.bus, module.address};
  const auto status = context.call(api::program::Status{{place}});
  const bool has_none = !status && status.error().outcome == tmcl::Outcome::refused;
  if (has_none || (status && status->state == "stopped")) return stopped;
  const auto ended = context.call(api::program::Stop{{place}});
  if (ended) return stop_motors(module, context);
  for (auto& row : stopped)
    if (!row.error) row.error = ended.error();
  return stopped;
}

Result<std::vector<StoppedAxis>> stop_found(Context& context) {
  std::vector<StoppedAxis> stopped;
  for (std::uint16_t first = 1; first <= stop_scan_last; first += stop_scan_step) {
    const auto last = static_cast<std::uint16_t>(first + stop_scan_step - 1);
    const auto found = scan({first, std::min(last, stop_scan_last)}, {}, context);
    if (!found) return tl::unexpected(found.error());
    if (!found->failed.empty()) return tl::unexpected(found->failed.front().error);
    for (const auto& module : found->modules)
      std::ranges::move(stop_module(module, context), std::back_inserter(stopped));
  }
  return stopped;
}

Result<std::vector<StoppedAxis>> stop_everything(Context& context) {
  if (context.gateway.axes_from == AxesFrom::scan) return stop_found(context);
  return context.call(api::system::StopAll{}).map([](const api::system::StoppedAxes& result) {
    std::vector<StoppedAxis> rows;
    for (const auto& [axis, milliseconds] : result.stopped)
      rows.push_back({axis, milliseconds, {}});
    for (const auto& [axis, error] : result.failed)
      rows.push_back({axis, {}, tmcl::client::error_from_json(error)});
    return rows;
  });
}

ExitCode show_stopped(const std::vector<StoppedAxis>& axes, Output& output) {
  json::array stopped;
  json::array failed;
  auto exit = ExitCode::done;
  for (const auto& row : axes) {
    if (row.error) {
      failed.push_back(json::object{{"axis", row.axis}, {"error", error_document(*row.error)}});
      exit = std::max(exit, exit_code_of(*row.error));
      if (!output.json)
        output.err << "tmclctl: " << row.axis
                   << " NOT stopped: " << error_text(*row.error, output.gateway) << '\n';
    } else {
      stopped.push_back(
          json::object{{"axis", row.axis}, {"milliseconds", row.milliseconds.value_or(0)}});
      if (!output.json) {
        output.out << fmt::format("{} stopped after {:.1f} ms\n", row.axis,
                                  row.milliseconds.value_or(0));
      }
    }
  }
  if (output.json)
    print_json({{"stopped", std::move(stopped)}, {"failed", std::move(failed)}}, output);
  return exit;
}

Result<ExitCode> run(const verb::Stop& verb, Context& context) {
  const auto stop_all = [&] {
    return stop_everything(context).map(
        [&](const std::vector<StoppedAxis>& axes) { return show_stopped(axes, context.output); });
  };
  if (verb.all) return stop_all();
  const auto stopped = context.call(api::axis::Stop{verb.axis});
  const bool names_none = !stopped && exit_code_of(stopped.error()) == ExitCode::usage;
  // An axis may have that name.
  if (names_none && is_all(verb.axis)) return stop_all();
  if (names_none) return tl::unexpected(stopped_nothing(stopped.error()));
  if (!stopped) return tl::unexpected(stopped.error());
  if (context.output.json) {
    print_json({{"axis", verb.axis}, {"stopped", true}}, context.output);
  } else {
    context.output.out << verb.axis << " stops\n";
  }
  return ExitCode::done;
}

constexpr const char* stop_help = R"(
Ramps down to standstill. A stop goes out before everything else. Through tmcld it says within a
second that the module has taken it; if it cannot, it says so and exits with 3 (nothing was sent) or 4
(it is not known). That is no emergency stop: such a one cuts the power.
--all, or 'all' where no axis is called so, stops every axis that tmcld knows; with --direct it looks for modules at the addresses 1 to
255 and stops each as soon as it is found. It also ends programs that modules run, which could move their motors again; a stop of one axis
does not.

  tmclctl stop x
  tmclctl stop --all
)";

}  // namespace

void add_stop(Grammar& grammar) {
  auto stop = grammar.verb<verb::Stop>("stop", access::acts, "Stop an axis, or all of them",
                                       stop_help, run);
  stop.optional_word("AXIS", axis_meaning, text(stop->axis));
  stop.flag("--all", "Every axis there is", stop->all);
  stop.object(
      [](const verb::Stop& said, bool) {
        return said.axis.empty() != said.all ? "name one axis, or say --all" : "";
      },
      "'tmclctl axes' lists the axes");
  stop.in_fleet(run_in_fleet);
}

}  // namespace tmclctl

#include "tmclctl.hpp"

#include <algorithm>
#include <csignal>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "command_line/options.hpp"
#include "fleet/fleet.hpp"
#include "output/print.hpp"
#include "verbs/ask.hpp"

namespace tmclctl {
namespace {

ExitCode complain(const Error& error, ExitCode exit, Output& output) {
  if (output.json) {
    print_json({{"error", error_document(error, exit)}}, output);
  } else {
    output.err << "tmclctl: " << error_text(error, output.gateway) << '\n';
  }
  return exit;
}

bool reads(const Options& options) {
  const auto* ask = std::any_cast<verb::Ask>(&options.verb.said);
  if (ask != nullptr) return only_reads(ask->method);
  return options.info->effect == VerbEffect::reads;
}

/// Where no answer leaves open whether something was done: a verb that reads has done nothing.
ExitCode complain(Error error, const Options& options, Output& output) {
  auto exit = exit_code_of(error);
  if (error.outcome == tmcl::Outcome::unknown) {
    if (reads(options) && exit == ExitCode::unknown) exit = ExitCode::not_sent;
    if (!reads(options) && options.info->effect == VerbEffect::acts)
      error.message += "; it may or may not have been executed";
  }
  return complain(error, exit, output);
}

/// How long the gateway is waited for, and how long all may take.
struct Patience {
  tmcl::Duration wait = usual_wait;
  std::optional<tmcl::Duration> in_all{};
};

Patience patience_of(const Options& options) {
  // The shell's completion must not hang.
  if (!options.info) return {tmcl::Duration{}};
  if (options.info->name == "stop") return {wait_before_stop, time_for_stop};
  return {};
}

/// `ready` stands for the gateway that the command line names, if it is there already.
Result<ExitCode> run_on_gateway(const Options& options, Output& output, Host& host,
                                Gateway* ready) {
  std::optional<Gateway> opened;
  if (ready == nullptr) {
    const auto [wait, in_all] = patience_of(options);
    auto gateway = open_gateway(options.where, wait, host, in_all);
    if (!gateway && options.verb.run_unreached)
      return options.verb.run_unreached(gateway.error(), options.where, output);
    if (!gateway) return tl::unexpected(gateway.error());
    ready = &opened.emplace(std::move(*gateway));
  }
  Context context{*ready, output, host};
  auto result = options.verb.run(context);
  const auto* line = std::any_cast<verb::Line>(&options.verb.said);
  const bool waited = line != nullptr && line->wait && result;
  const auto seen = wait_for_motion_to_end(context, !waited);
  if (!seen) return tl::unexpected(seen.error());
  return result;
}

/// The verbs that do something with --fleet.
std::string verbs_of_fleets() {
  std::string names;
  for (const auto& verb : verb_table())
    if (verb.in_fleet) names += (names.empty() ? "" : ", ") + verb.name;
  return names;
}

std::optional<Error> refusal_by_fleet(const Options& options) {
  const auto& info = options.info;
  const bool is_fleet = !options.where.fleet.url.empty();
  if (info && is_fleet && !info->in_fleet)
    return usage_error("usage", fmt::format("'tmclctl {}' does nothing with --fleet", info->name),
                       "with --fleet go: " + verbs_of_fleets());
  if (info && !is_fleet && info->doors == Doors::fleet_only)
    return usage_error(
        "usage", fmt::format("'tmclctl {}' needs a broker: --fleet mqtts://HOST", info->name));
  return {};
}

std::optional<Error> refusal(const Options& options) {
  const auto& info = options.info;
  if (options.where.direct.empty() || !info || info->doors != Doors::tmcld_only) return {};
  return usage_error("method_not_found", fmt::format("'tmclctl {}' needs a running tmcld: {}",
                                                     info->name, info->reason));
}

Result<ExitCode> run_in_fleet(const Options& options, Output& output, Host& host) {
  auto place = options.where.fleet;
  place.ca_file = options.where.web.ca_file;
  const auto link = open_fleet(place, host);
  if (!link) return tl::unexpected(link.error());
  Fleet fleet(**link, place, output, host);
  return options.verb.run_in_fleet(fleet);
}

Result<ExitCode> run(const Options& options, Output& output, Host& host, Gateway* ready) {
  if (auto refused = refusal_by_fleet(options)) return tl::unexpected(std::move(*refused));
  if (options.verb.run_alone) return options.verb.run_alone(output);
  if (auto refused = refusal(options)) return tl::unexpected(std::move(*refused));
  host.catch_signals();
  if (options.verb.run_in_fleet && !options.where.fleet.url.empty())
    return run_in_fleet(options, output, host);
  if (options.verb.run_on_ports) return options.verb.run_on_ports(options.where, output, host);
  return run_on_gateway(options, output, host, ready);
}

/// A disk may be full.
ExitCode with_output_written(ExitCode exit, Output& output) {
  if (output.out.flush() || exit != ExitCode::done) return exit;
  output.err << "tmclctl: it was done, but the output cannot be written\n";
  return ExitCode::refused;
}

ExitCode run_with(const std::vector<std::string>& arguments, Output& output, Host& host,
                  Gateway* ready) {
  // Also for the errors of a command line that cannot be read.
  output.json = std::ranges::find(arguments, "--json") != arguments.end();
  const auto parsed = parse_options(arguments);
  if (!parsed) return complain(parsed.error(), exit_code_of(parsed.error()), output);
  if (const auto* information = std::get_if<Information>(&*parsed)) {
    output.out << information->text;
    return ExitCode::done;
  }
  const auto& options = std::get<Options>(*parsed);
  output.tables = options.tables;
  if (ready == nullptr) output.gateway = options_of(options.where);
  const auto result = run(options, output, host, ready);
  if (result) return *result;
  auto error = result.error();
  if (!options.info) return exit_code_of(error);
  if (error.kind == ErrorKind::interrupted && host.signal() != 0)
    error.subject["signal"] = host.signal();
  return complain(std::move(error), options, output);
}

}  // namespace

ExitCode run(const std::vector<std::string>& arguments, Output& output, Host& host) {
  return with_output_written(run_with(arguments, output, host, nullptr), output);
}

ExitCode run(const std::vector<std::string>& arguments, Output& output, Host& host,
             Gateway& gateway) {
  return run_with(arguments, output, host, &gateway);
}

}  // namespace tmclctl

// lease run, lease list, lease break.
#include <csignal>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "axis/held_lease.hpp"
#include "command_line/child_process.hpp"
#include "command_line/lease_environment.hpp"
#include "output/print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

// How often it is looked whether the program has ended, and whether a signal came.
constexpr tmcl::Duration lease_look_interval = std::chrono::milliseconds(20);

template <class Method>
Method on(const api::lease::Granted& lease) {
  Method method;
  method.lease = lease.lease;
  method.epoch = lease.epoch;
  return method;
}

/// Renews the lease until the program has ended; then its exit code.
Result<int> lead(ChildProcess& program, const api::lease::Granted& lease, Context& context) {
  const tmcl::Duration interval = std::chrono::milliseconds(lease.ttl_ms) / renewals_in_ttl;
  auto renewed = context.host.now();
  while (true) {
    if (const auto code = program.exit_code()) return *code;
    if (const int signal = context.host.take_signal(); signal != 0) {
      context.host.catch_signals();
      // From a terminal SIGINT has come to the program as well.
      if (signal != SIGINT) program.send(signal);
    }
    context.sleep(lease_look_interval);
    if (context.host.now() - renewed < interval) continue;
    const auto granted = context.call(on<api::lease::Renew>(lease));
    if (!granted) return tl::unexpected(granted.error());
    renewed = context.host.now();
  }
}

Error lost(Error failure, ChildProcess& program) {
  program.send(SIGTERM);
  failure.kind = ErrorKind::ended_early;
  failure.message = "the lease was lost, and the program was told to end: " + failure.message;
  return failure;
}

Result<ExitCode> run(const verb::RunLeased& verb, Context& context) {
  if (verb.command.empty())
    return tl::unexpected(usage_error("usage", "say what is to be run: AXIS... -- COMMAND..."));
  api::lease::Acquire wanted{verb.axes};
  if (verb.ttl_s) wanted.ttl_ms = static_cast<std::int64_t>(*verb.ttl_s * 1000);
  const auto lease = context.call(wanted);
  if (!lease) return tl::unexpected(lease.error());
  set_in_environment({lease->lease, lease->epoch});
  auto program = ChildProcess::start(verb.command);
  if (!program) return tl::unexpected(program.error());
  const auto code = lead(*program, *lease, context);
  if (!code) return tl::unexpected(lost(code.error(), *program));
  const auto released = context.call(on<api::lease::Release>(*lease));
  if (!released) return tl::unexpected(released.error());
  return static_cast<ExitCode>(*code);
}

Result<ExitCode> run(const verb::Leases&, Context& context) {
  const auto all = context.call(api::lease::List{});
  if (!all) return tl::unexpected(all.error());
  if (context.output.json) {
    print_json(api::to_json(*all), context.output);
    return ExitCode::done;
  }
  Table table({"LEASE", "AXES", "HOLDER", "SINCE", "EXPIRES IN"});
  for (const auto& lease : all->leases) {
    table.add({std::to_string(lease.lease), fmt::format("{}", fmt::join(lease.axes, " ")),
               lease.holder, fmt::format("{:.1f} s", lease.since_s),
               fmt::format("{} ms", lease.expires_ms)});
  }
  table.print(context.output);
  return ExitCode::done;
}

Result<ExitCode> run(const verb::BreakLease& verb, Context& context) {
  const auto broken = context.call(api::lease::Break{verb.axis});
  if (!broken) return tl::unexpected(broken.error());
  if (context.output.json) {
    print_json({{"axis", verb.axis}, {"broken", true}}, context.output);
  } else {
    context.output.out << verb.axis << " has no lease any more\n";
  }
  return ExitCode::done;
}

constexpr std::string_view alone = "with --direct there is no other client";
constexpr double shortest_ttl_s = 0.2;
constexpr double longest_ttl_s = 60;

constexpr const char* lease_help = R"(
Who has a lease of axes is the only one who can move them, or change the settings of their modules;
everybody can read and stop. 'lease run' takes one, runs COMMAND, and ends with its exit code. The
lease is renewed as long as COMMAND runs; then the axes are stopped. Every tmclctl that COMMAND starts
moves them under this lease: it is passed on in TMCL_LEASE and TMCL_EPOCH. If this program is killed or
hangs, the axes stop.

  exit     that of COMMAND
       5   the lease was lost; COMMAND was sent SIGTERM

  tmclctl lease run x y -- ./measure.sh
  tmclctl lease list
  tmclctl lease break x
)";

}  // namespace

void add_leases(Grammar& grammar) {
  const auto group =
      grammar.group("lease", "The right of one program alone to move axes", lease_help);
  auto leased = grammar.verb<verb::RunLeased>(
      group, "run", access::tmcld_only(VerbEffect::tells, alone),
      "Run a program that has axes for itself: AXIS... -- COMMAND...", lease_help, run);
  leased.words("AXIS", axis_meaning, texts(leased->axes));
  leased.option("--ttl", "SECONDS",
                "The axes stop so long after this program has been lost (default 2)",
                number(leased->ttl_s, shortest_ttl_s, longest_ttl_s));
  leased.command(leased->command);
  leased.object([](const verb::RunLeased& said, bool) {
    return said.axes.empty() ? "name at least one AXIS" : "";
  });
  grammar.verb<verb::Leases>(group, "list", access::tmcld_only(VerbEffect::reads, alone),
                             "Who has which axes", lease_help, run);
  auto breaks = grammar.verb<verb::BreakLease>(
      group, "break", access::tmcld_only(VerbEffect::acts, alone),
      "Take the lease of an axis away; it is stopped", lease_help, run);
  breaks.axis(breaks->axis);
}

}  // namespace tmclctl

// clients, audit.
#include <chrono>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "output/print.hpp"
#include "tmcl/api/client.hpp"
#include "tmcl/utc_text.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;

constexpr int digits_of_audit_time = 3;
constexpr std::int32_t most_audit_lines = 1000;

Result<ExitCode> run(const verb::Clients&, Context& context) {
  const auto all = context.call(api::clients::List{});
  if (!all) return tl::unexpected(all.error());
  if (context.output.json) {
    print_json(api::to_json(*all), context.output);
    return ExitCode::done;
  }
  Table table({"CLIENT", "BY", "ROLE", "LEASED", "SINCE", "REQUESTS"});
  for (const auto& one : all->clients) {
    table.add({one.client, one.door, one.role, fmt::format("{}", fmt::join(one.axes, " ")),
               fmt::format("{:.0f} s", one.since_s), std::to_string(one.requests)});
  }
  table.print(context.output);
  return ExitCode::done;
}

/// As the audit file has it.
std::string text_of(const api::audit::Line& line) {
  const auto when = tmcl::UtcTime(std::chrono::microseconds(line.utc_us));
  auto text = tmcl::to_text(when, digits_of_audit_time);
  if (line.uid && line.pid) text += fmt::format(" uid={} pid={}", *line.uid, *line.pid);
  return text + " " + line.text;
}

Result<ExitCode> run(const verb::Audit& verb, Context& context) {
  const auto tail = context.call(api::audit::Tail{verb.last});
  if (!tail) return tl::unexpected(tail.error());
  if (context.output.json) {
    print_json(api::to_json(*tail), context.output);
    return ExitCode::done;
  }
  for (const auto& line : tail->lines) context.output.out << text_of(line) << '\n';
  return ExitCode::done;
}

constexpr std::string_view alone = "with --direct there is no other client";

constexpr const char* clients_help = R"(
Who is connected to tmcld now: who it is, by which door it came (socket, http, websocket, or a port for
hosts that speak TMCL), its role, the axes that it has leased, for how long it has been connected, and how
many of its requests are in progress. This command is one of them. It needs the role configure.

  tmclctl clients
)";

constexpr const char* audit_help = R"(
The last lines of the audit, which say what was moved, set and stopped, by whom, and what came of it.
tmcld remembers 1000 lines since it was started, wherever else it writes them: 'audit' of [daemon] in
tmcld.toml names a file for all of them. It needs the role configure.

  tmclctl audit
  tmclctl audit --last 500
)";

}  // namespace

void add_clients(Grammar& grammar) {
  grammar.verb<verb::Clients>("clients", access::tmcld_only(VerbEffect::reads, alone),
                              "Show who is connected", clients_help, run);
  auto audit =
      grammar.verb<verb::Audit>("audit", access::tmcld_only(VerbEffect::reads, alone),
                                "Show what was moved and set lately, by whom", audit_help, run);
  audit.option("--last", "N", "So many lines (default 100)",
               number(audit->last, 1, most_audit_lines));
}

}  // namespace tmclctl

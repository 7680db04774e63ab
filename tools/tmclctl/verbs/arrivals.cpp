// arrivals.
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "output/print.hpp"
#include "tmcl/api/system.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using Motors = std::vector<std::uint8_t>;

json::array to_json(const Motors& motors) { return json::array(motors.begin(), motors.end()); }

void print(const ModuleName& module, const Motors& motors, double at_s, Output& output) {
  if (output.json) {
    return print_json({{"address", module.address}, {"motors", to_json(motors)}, {"time_s", at_s}},
                      output);
  }
  output.out << fmt::format("{:9.3f} s  module {}: motor {} arrived", at_s, module.address,
                            fmt::join(motors, " and motor "))
             << std::endl;
}

/// Told the motors that have just arrived; null when a while went by without any. False ends it.
using ArrivalHandler = std::function<bool(const Motors* motors)>;

/// Hears the arrivals that a module tells of, which `ask` lets it do, once they can be heard.
Result<void> subscribe_arrivals(const api::OnModule& module, const api::module::ReportArrivals& ask,
                                const ArrivalHandler& on_arrival, Context& context) {
  // Any subscription, to no axis even, brings events.
  const auto subscribed = context.call(api::Subscribe{std::vector<std::string>{}});
  if (!subscribed) return tl::unexpected(subscribed.error());
  const auto asked = context.call(ask);
  if (!asked) return tl::unexpected(asked.error());
  bool wanted = true;
  const tmcl::client::Hearing<api::Event> hearing(
      context.gateway.caller, api::Event::notification, [&](const api::Event& event) {
        const bool concerns_us = event.kind == "target_reached" && event.bus == module.bus &&
                                 event.address == module.address;
        if (!concerns_us || !wanted) return;
        const auto motors = event.motors.value_or(Motors{});
        wanted = on_arrival(&motors);
      });
  while (wanted) {
    const auto listened = context.gateway.caller.listen(longest_silence);
    if (!listened && listened.error().kind != ErrorKind::interrupted) return listened;
    if (wanted) wanted = on_arrival(nullptr);
  }
  return {};
}

Result<ExitCode> run(const verb::Arrivals& verb, Context& context) {
  const auto module = parse_module(verb.module);
  if (!module) return tl::unexpected(module.error());
  const auto named = on_module(*module, context);
  if (!named) return tl::unexpected(named.error());
  const auto every = verb.next ? std::nullopt : std::optional(true);
  const api::module::ReportArrivals ask{{*named}, verb.motors, every};
  if (verb.off) {
    const auto off = context.call(ask);
    if (!off) return tl::unexpected(off.error());
    if (context.output.json)
      print_json({{"address", module->address}, {"motors", to_json(verb.motors)}, {"off", true}},
                 context.output);
    return ExitCode::done;
  }
  const auto begin = context.host.now();
  const auto elapsed_s = [&] {
    return std::chrono::duration<double>(context.host.now() - begin).count();
  };
  std::set<std::uint8_t> missing(verb.motors.begin(), verb.motors.end());
  const auto note = [&](const Motors* motors) {
    if (motors != nullptr) {
      print(*module, *motors, elapsed_s(), context.output);
      for (const auto motor : *motors) missing.erase(motor);
    }
    // Ending it is what Ctrl-C is for here, so that is no error.
    return context.host.signal() == 0 && !(verb.next && missing.empty()) &&
           !(verb.for_s && elapsed_s() >= *verb.for_s);
  };
  const auto heard = subscribe_arrivals(*named, ask, note, context);
  if (!heard && context.host.signal() == 0) return tl::unexpected(heard.error());
  return ExitCode::done;
}

constexpr std::uint8_t last_motor_to_tell = 30;

constexpr const char* arrivals_help = R"(
Asks the module to tell whenever one of these motors reaches the target of a move that starts from
now on, and shows that until Ctrl-C or the end of --for; with --next until each has arrived once. The
module goes on telling then: --off ends that. With --json, one document a line.

  tmclctl arrivals 1 0 1 2
  tmclctl arrivals 1 0 --next
  tmclctl arrivals 1 --off
)";

}  // namespace

void add_arrivals(Grammar& grammar) {
  auto arrivals = grammar.verb<verb::Arrivals>(
      "arrivals", access::tells, "Let a module tell when motors arrive", arrivals_help, run);
  arrivals.module(arrivals->module);
  arrivals.words("MOTOR", "One or more", numbers(arrivals->motors, 0, last_motor_to_tell));
  arrivals.flag("--next", "Only of the next move of each", arrivals->next);
  arrivals.flag("--off", "Let it tell no more", arrivals->off);
  arrivals.option("--for", "SECONDS", "End after so long",
                  number(arrivals->for_s, shortest_time_s, longest_time_s));
  arrivals.object([](const verb::Arrivals& said, bool) {
    if (!said.off) return said.motors.empty() ? "name at least one motor, or say --off" : "";
    const bool says_more = !said.motors.empty() || said.next || said.for_s;
    return says_more ? "--off goes with nothing else" : "";
  });
}

}  // namespace tmclctl

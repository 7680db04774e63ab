// call.
#include <algorithm>

#include <fmt/format.h>
#include <boost/json/parse.hpp>

#include "api/method.hpp"
#include "fleet/fleet_answers.hpp"
#include "output/print.hpp"
#include "tmcl/json_text.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr double usual_patience_s = 15;
constexpr double longest_patience_s = 86'400;

Result<json::object> params_of(const verb::Call& verb) {
  if (verb.params.empty()) return json::object();
  boost::system::error_code error;
  auto value = json::parse(verb.params, error);
  if (!error && value.is_object()) return std::move(value.get_object());
  return tl::unexpected(
      usage_error("bad_params", fmt::format("'{}' is no JSON object", verb.params),
                  R"(such as '{"axis": "x"}': docs/PROTOCOL.md has the methods)"));
}

tmcl::Duration patience_of(const verb::Call& verb) {
  return std::chrono::duration_cast<tmcl::Duration>(
      std::chrono::duration<double>(verb.timeout_s.value_or(usual_patience_s)));
}

Result<ExitCode> run(const verb::Call& verb, Context& context) {
  auto params = params_of(verb);
  if (!params) return tl::unexpected(params.error());
  const auto result =
      context.gateway.caller.call(verb.method, std::move(*params), {.timeout = patience_of(verb)});
  if (!result) return tl::unexpected(result.error());
  print_json(*result, context.output);
  return ExitCode::done;
}

/// What this program does not know may do most.
FleetCall call_on(const std::string& gateway, const verb::Call& verb, const json::object& params) {
  const auto* method = tmcld::find_method(verb.method);
  const bool acts = method == nullptr || method->effect == tmcl::Effect::moves ||
                    method->effect == tmcl::Effect::writes;
  return {gateway, verb.method, params, acts, {}};
}

std::string role_of(const verb::Call& verb) {
  if (!verb.role.empty()) return verb.role;
  const auto* method = tmcld::find_method(verb.method);
  return std::string(tmcld::name_of(method == nullptr ? tmcld::Role::operate : method->role));
}

Result<ExitCode> call_in_fleet(const verb::Call& verb, Fleet& fleet) {
  const auto params = params_of(verb);
  if (!params) return tl::unexpected(params.error());
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  FleetAnswers answers(fleet);
  std::vector<FleetCall> calls;
  for (const auto& gateway : answers.askable()) calls.push_back(call_on(gateway, verb, *params));
  return answers.ask(
      role_of(verb), std::move(calls),
      [&](const FleetCall& call, const json::object& result) {
        answers.document_of(call.gateway)["result"] = result;
        if (fleet.output.json) return;
        fleet.output.out << fmt::format("{:<{}}  {}\n", call.gateway, gateway_width,
                                        tmcl::json_text(result))
                         << std::flush;
      },
      patience_of(verb));
}

constexpr const char* call_help = R"(
For what no other verb does, and to try a method before a program uses it. PARAMS is a JSON object; without
one the method gets none. Prints the result as JSON, on one line. With --fleet it calls the method on many
gateways at once, prints a line for each as it answers, and says which did not: a method that moves or
sets something is called with a nonce, which costs a round trip more. A lease that it acquires ends with its
connection.

  tmclctl call axis.get_state '{"axis":"x"}'
  tmclctl --fleet mqtts://broker.example --cert anna.crt --key anna.key -g 'hall3-*' call axis.list
)";

}  // namespace

void add_call(Grammar& grammar) {
  auto call = grammar.verb<verb::Call>("call", access::acts, "Call a method by its name, with JSON",
                                       call_help, run);
  call.word("METHOD", "Its name, such as axis.get_state", text(call->method));
  call.optional_word("PARAMS", "A JSON object", text(call->params));
  call.option("--timeout", "SECONDS", "How long an answer may take (default 15)",
              [into = &call->timeout_s](const std::string& typed) {
                double seconds = 0;
                return read_time(typed, shortest_time_s, longest_patience_s, seconds).map([&] {
                  *into = seconds;
                });
              });
  call.option("--role", "ROLE",
              "With --fleet: in which it is called: stop, observe, operate or configure",
              text(call->role));
  call.object([](const verb::Call& said, bool) {
    const bool is_role = said.role.empty() || std::ranges::count(tmcld::role_names, said.role) != 0;
    return is_role ? "" : "--role is stop, observe, operate or configure";
  });
  call.in_fleet(call_in_fleet);
}

}  // namespace tmclctl

#include "fleet/fleet_verbs.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "connection/json_read.hpp"
#include "fleet/fleet_answers.hpp"
#include "fleet/stop_round.hpp"
#include "output/print.hpp"
#include "output/progress_line.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;

constexpr std::size_t axis_width = 12;
constexpr tmcl::Duration stop_takes_at_most = std::chrono::seconds(20);
constexpr tmcl::Duration stop_look = std::chrono::milliseconds(10);

AxisReading reading_of(const json::object& state) {
  AxisReading reading;
  static_cast<api::axis::State&>(reading) = api::from_json<api::axis::State>(state);
  return reading;
}

}  // namespace

Result<ExitCode> run_in_fleet(const verb::FleetGateways&, Fleet& fleet) {
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  json::array documents;
  Table table({"GATEWAY", "STATE", "TMCLD", "AXES"});
  for (const auto& [name, gateway] : fleet.gateways.all()) {
    const auto* state = gateway.online ? (gateway.daemon.empty() ? "no tmcld" : "online") : "away";
    table.add({name, state, gateway.daemon.empty() ? "-" : gateway.daemon, joined(gateway.axes)},
              !gateway.online || gateway.daemon.empty());
    json::object document{{"gateway", name}, {"online", gateway.online}, {"tmcld", nullptr}};
    if (!gateway.daemon.empty()) document["tmcld"] = gateway.daemon;
    document["axes"] = json::array(gateway.axes.begin(), gateway.axes.end());
    documents.push_back(std::move(document));
  }
  if (fleet.output.json) {
    print_json({{"gateways", std::move(documents)}}, fleet.output);
  } else {
    table.print(fleet.output);
  }
  return ExitCode::done;
}

Result<ExitCode> run_in_fleet(const verb::Axes&, Fleet& fleet) {
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  FleetAnswers answers(fleet);
  std::vector<FleetCall> calls;
  for (const auto& gateway : answers.askable()) calls.push_back({gateway, "axis.list"});
  GrowingTable table({"GATEWAY", "AXIS", "BUS", "ADDRESS", "MOTOR", "MODEL", "STATE", "UNIT"},
                     {gateway_width, axis_width, 8, 7, 5, 10, 10, 4});
  return answers.ask("observe", std::move(calls),
                     [&](const FleetCall& call, const json::object& result) {
                       answers.document_of(call.gateway)["axes"] = array_at(result, "axes");
                       if (fleet.output.json) return;
                       for (const auto& row : api::from_json<api::axis::Axes>(result).axes)
                         table.add({call.gateway, row.name, row.bus, std::to_string(row.address),
                                    std::to_string(row.motor), row.model.value_or("unknown"),
                                    row.state, row.unit.value_or("-")},
                                   fleet.output.out);
                     });
}

Result<ExitCode> run_in_fleet(const verb::State& verb, Fleet& fleet) {
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  FleetAnswers answers(fleet);
  std::vector<FleetCall> calls;
  for (const auto& gateway : answers.askable()) {
    for (const auto& axis : fleet.gateways.all().at(gateway).axes)
      if (verb.axis.empty() || verb.axis == axis)
        calls.push_back({gateway, "axis.get_state", {{"axis", axis}}, false, axis});
  }
  if (calls.empty() && !verb.axis.empty())
    return tl::unexpected(usage_error("unknown_axis",
                                      fmt::format("no gateway has an axis '{}'", verb.axis),
                                      "'tmclctl --fleet ... axes' lists them"));
  GrowingTable table({"GATEWAY", "AXIS", "POSITION", "TARGET", "VELOCITY", "STATE"},
                     {gateway_width, axis_width, 16, 16, 16, 12});
  return answers.ask("observe", std::move(calls),
                     [&](const FleetCall& call, const json::object& result) {
                       answers.add_axis(call.gateway, result);
                       if (fleet.output.json) return;
                       const auto reading = reading_of(result);
                       table.add({call.gateway, reading.axis, position_text(reading, verb.internal),
                                  target_text(reading, verb.internal),
                                  velocity_text(reading, verb.internal), remark_on(reading)},
                                 fleet.output.out);
                     });
}

namespace {

/// One axis of each gateway, by its method.
Result<ExitCode> stop_axis(const std::string& axis, Fleet& fleet) {
  if (auto found = fleet.find(); !found) return tl::unexpected(found.error());
  FleetAnswers answers(fleet);
  std::vector<FleetCall> calls;
  for (const auto& gateway : answers.askable()) {
    if (std::ranges::count(fleet.gateways.all().at(gateway).axes, axis) != 0)
      calls.push_back({gateway, "axis.stop", {{"axis", axis}}, false, axis});
  }
  if (calls.empty())
    return tl::unexpected(usage_error("unknown_axis",
                                      fmt::format("no gateway has an axis '{}'", axis),
                                      "everything goes on moving; 'stop --all' stops all axes"));
  return answers.ask("stop", std::move(calls), [&](const FleetCall& call, const json::object&) {
    answers.add_axis(call.gateway, {{"axis", axis}, {"stopped", true}});
    if (!fleet.output.json) fleet.output.out << call.gateway << ' ' << axis << " stops\n";
  });
}

void show_stopped(const std::string& gateway, const StopRound& round, std::set<std::string>& shown,
                  Output& output) {
  if (output.json) return;
  for (const auto& [axis, milliseconds] : round.stopped(gateway)) {
    if (shown.insert(gateway + '/' + axis).second)
      output.out << fmt::format("{} {} stopped after {:.1f} ms\n", gateway, axis, milliseconds);
  }
  output.out.flush();
}

ExitCode show_end(const StopRound& round, Fleet& fleet) {
  FleetAnswers answers(fleet);
  for (const auto& [name, gateway] : fleet.gateways.all()) {
    for (const auto& [axis, milliseconds] : round.stopped(name))
      answers.add_axis(name, {{"axis", axis}, {"milliseconds", milliseconds}});
  }
  const auto fail = [&](const std::string& gateway, const std::string& axis, std::string message,
                        tmcl::Outcome outcome) {
    answers.fail(gateway,
                 {"not_stopped", ErrorKind::failed, outcome, "NOT stopped: " + std::move(message),
                  "a stop can be sent on the gateway itself"},
                 axis);
  };
  for (const auto& one : round.missing())
    fail(one.gateway, one.axis, one.why, tmcl::Outcome::unknown);
  for (const auto& name : round.away())
    fail(name, {}, "the gateway is not on the broker", tmcl::Outcome::not_sent);
  for (const auto& name : round.unknown())
    fail(name, {}, "no gateway is called so", tmcl::Outcome::not_sent);
  return answers.end();
}

std::string missing_text(const StopRound& round, const Screen& screen) {
  const auto missing = round.missing();
  std::string names;
  for (const auto& one : missing)
    names += ' ' + one.gateway + (one.axis.empty() ? "" : "/" + one.axis);
  return alarming(fmt::format("{} not acknowledged:{}", missing.size(), names), screen);
}

}  // namespace

Result<ExitCode> run_in_fleet(const verb::Stop& verb, Fleet& fleet) {
  if (!verb.all) return stop_axis(verb.axis, fleet);
  StopRound round(fleet.gateways, fleet.link.user(), fleet.link.id());
  std::set<std::string> shown;
  fleet.link.subscribe(round.filter());
  const auto hear = [&](const tmclmqtt::Message& message) {
    if (const auto gateway = round.hear(message); !gateway.empty())
      show_stopped(gateway, round, shown, fleet.output);
  };
  const auto publish = [&] {
    for (const auto& stop : round.due(fleet.host.now())) fleet.link.publish(stop);
  };
  const auto deadline = fleet.host.now() + stop_takes_at_most;
  // It begins before it is known which gateways there are.
  auto heard = fleet.learn(hear, publish);
  round.know_gateways();
  fleet.on_message = hear;
  ProgressLine line(fleet.output);
  while (heard && !round.is_done() && fleet.host.now() < deadline) {
    publish();
    line.show(missing_text(round, line.screen()));
    heard = fleet.listen(stop_look);
  }
  line.clear();
  for (const auto& [name, gateway] : fleet.gateways.all())
    show_stopped(name, round, shown, fleet.output);
  fleet.on_message = {};
  const auto exit = show_end(round, fleet);
  if (!heard) return tl::unexpected(heard.error());
  return exit;
}

}  // namespace tmclctl

#include "fleet/fleet.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "broker/topic_levels.hpp"

namespace tmclctl {
namespace {

constexpr tmcl::Duration listening = std::chrono::milliseconds(20);
// For a broker that lets this user not publish what shows that all births have come.
constexpr tmcl::Duration births_take_at_most = std::chrono::seconds(2);

}  // namespace

Fleet::Fleet(FleetLink& to, const FleetPlace& place, Output& its_output, Host& its_host)
    : link(to), output(its_output), host(its_host), gateways(place.gateways) {
  link.on_message([this](const tmclmqtt::Message& message) {
    gateways.hear(message);
    if (on_message) on_message(message);
  });
}

Result<void> Fleet::listen(tmcl::Duration at_most) {
  if (auto heard = link.listen(at_most); !heard) return heard;
  if (host.signal() == 0) return {};
  return tl::unexpected(interrupted_error(host.signal(), "not all gateways have answered yet", ""));
}

Result<void> Fleet::learn(const std::function<void(const tmclmqtt::Message&)>& on_other,
                          const std::function<void()>& meanwhile) {
  // A broker hands out what it keeps before what is published later on the same connection. The
  // topic is one of answers, which a user may write to as if a gateway had its name.
  const auto marker = tmclmqtt::reply_topic(link.user(), link.user(), link.id());
  bool has_come = false;
  on_message = [&](const tmclmqtt::Message& message) {
    has_come = has_come || message.topic == marker;
    if (on_other) on_other(message);
  };
  link.subscribe(marker);
  link.subscribe(Gateways::filter);
  link.publish({.topic = marker, .payload = "{}"});
  const auto deadline = host.now() + births_take_at_most;
  Result<void> heard;
  while (!has_come && heard && host.now() < deadline) {
    if (meanwhile) meanwhile();
    heard = listen(listening);
  }
  on_message = {};
  return heard;
}

Result<void> Fleet::find() {
  if (auto learned = learn({}, {}); !learned) return learned;
  const auto unknown = gateways.unknown();
  if (unknown.empty()) return {};
  return tl::unexpected(usage_error(
      "unknown_gateway", fmt::format("no gateway is called {}", fmt::join(unknown, ", ")),
      "'tmclctl --fleet ... fleet gateways' lists those that the broker knows"));
}

Result<void> Fleet::call(const std::string& role, std::vector<FleetCall> calls,
                         CallRound::OnAnswer on_answer, tmcl::Duration patience) {
  CallRound round({link.user(), link.id(), role, patience}, std::move(calls), std::move(on_answer));
  link.subscribe(round.filter());
  on_message = [&](const tmclmqtt::Message& message) { round.hear(message, host.now()); };
  Result<void> heard;
  while (heard && !round.is_done()) {
    for (const auto& [name, gateway] : gateways.all())
      if (!gateway.online) round.give_up(name);
    for (const auto& publication : round.due(host.now())) link.publish(publication);
    if (!round.is_done()) heard = listen(listening);
  }
  on_message = {};
  return heard;
}

}  // namespace tmclctl

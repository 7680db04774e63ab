#include "fleet/client.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <boost/json/parse.hpp>

#include "async/rest.hpp"
#include "broker/topic_levels.hpp"
#include "fleet/names.hpp"
#include "fleet/say.hpp"

namespace tmclfleet {
namespace {

namespace json = boost::json;
using boost::asio::awaitable;

constexpr auto user = "anna";
constexpr auto role = "operate";
constexpr auto stop_interval = std::chrono::milliseconds(100);
constexpr auto issue_interval = std::chrono::milliseconds(5);
constexpr auto patience = std::chrono::seconds(60);
constexpr std::uint32_t wish_s = 3600;
constexpr std::uint32_t most_packet_bytes = 1U << 20U;
// No axis gets there before it is sent the other way.
constexpr int far_away = 8'000'000;

double ms(tmcl::Duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

json::object quantiles(std::vector<double> all) {
  if (all.empty()) return {{"count", 0}};
  std::ranges::sort(all);
  const auto at = [&](std::size_t percent) { return all[(all.size() - 1) * percent / 100]; };
  return {{"count", all.size()}, {"p50", at(50)}, {"p99", at(99)}, {"max", all.back()}};
}

json::object parsed(const std::string& text) {
  boost::system::error_code error;
  auto value = json::parse(text, error);
  return error || !value.is_object() ? json::object() : std::move(value.get_object());
}

std::string text_of(const json::object& said, std::string_view name) {
  const auto* value = said.if_contains(name);
  return value != nullptr && value->is_string() ? std::string(value->get_string()) : std::string();
}

}  // namespace

awaitable<void> FleetClient::run() {
  co_await connect();
  say({{"event", "connected"}});
  co_await await_births();
  want_telemetry();
  const auto axes = static_cast<double>(options_.gateways) * axes_of_a_gateway;
  const std::chrono::duration<double> a_round(axes / options_.calls_per_second);
  co_await make_calls(std::chrono::duration_cast<tmcl::Duration>(a_round));
  is_measuring_ = true;
  say({{"event", "measuring"}});
  co_await make_calls(std::chrono::seconds(options_.measured_s));
  is_measuring_ = false;
  co_await await_answers();
  say_measured();
  co_await stop_all();
  context_.stop();
}

awaitable<void> FleetClient::connect() {
  auto options = place_.connection_of(user, user);
  options.max_packet_bytes = most_packet_bytes;
  auto connecting = tmclmqtt::connect_to_broker(
      workers_, std::move(options), [this](const auto& message) { take(message); }, [] {});
  auto connected = co_await std::move(connecting);
  if (!connected) throw std::runtime_error("no broker: " + connected.error());
  broker_ = std::move(*connected);
  broker_->subscribe({"tmcl/v1/+/birth", 0});
  broker_->subscribe({"tmcl/v1/+/telemetry/+", 0});
  broker_->subscribe({fmt::format("tmcl/v1/reply/{}/#", user), 0});
}

awaitable<void> FleetClient::await_births() {
  const auto are_all_there = [this] {
    const auto there = std::ranges::count_if(
        gateways_, [](const auto& one) { return one.second.has_axes && !one.second.is_away; });
    return static_cast<std::size_t>(there) >= options_.gateways;
  };
  while (!are_all_there()) co_await tmcld::rest(issue_interval);
  say({{"event", "births"}, {"gateways", gateways_.size()}});
}

void FleetClient::want_telemetry() {
  wanted_ = clock_.now();
  for (const auto& [name, gateway] : gateways_) {
    broker_->publish({.topic = fmt::format("tmcl/v1/{}/want/{}", name, user),
                      .payload = "{}",
                      .retained = true,
                      .expiry_s = wish_s});
  }
}

// ---- calls -------------------------------------------------------------------------------------

awaitable<void> FleetClient::make_calls(tmcl::Duration time) {
  const auto began = clock_.now();
  std::size_t made = 0;
  while (clock_.now() - began < time) {
    const auto elapsed = std::chrono::duration<double>(clock_.now() - began).count();
    const auto due = static_cast<std::size_t>(elapsed * options_.calls_per_second);
    for (; made < due; ++made) {
      begin_read();
      begin_move();
    }
    co_await tmcld::rest(issue_interval);
  }
}

void FleetClient::begin_read() {
  const auto number = reads_++;
  // Another gateway than that which is asked to move now.
  const auto gateway = (number + options_.gateways / 2) % options_.gateways;
  const auto axis = name_of_axis(static_cast<int>(number / options_.gateways % axes_of_a_gateway));
  send({Kind::read, gateway, 0, clock_.now(), {}}, "axis.get_state",
       fmt::format(R"({{"params":{{"axis":"{}"}}}})", axis));
}

void FleetClient::begin_move() {
  const auto number = moves_++;
  send({Kind::nonce, number % options_.gateways, number, clock_.now(), {}}, "nonce", "{}");
}

/// Each axis the other way than before.
void FleetClient::end_move_with(const Call& call, const json::object& answer) {
  const auto axis = call.move / options_.gateways;
  const auto target = axis / axes_of_a_gateway % 2 == 0 ? far_away : -far_away;
  auto move = call;
  move.kind = Kind::move;
  send(move, "axis.move_to",
       fmt::format(
           R"({{"params":{{"axis":"{}","position_microsteps":{}}},"epoch":"{}","nonce":"{}"}})",
           name_of_axis(static_cast<int>(axis % axes_of_a_gateway)), target,
           text_of(answer, "epoch"), text_of(answer, "nonce")));
}

void FleetClient::send(const Call& call, std::string_view method, std::string payload) {
  const auto id = ++last_call_;
  calls_[id] = call;
  calls_[id].sent = clock_.now();
  const auto name = name_of_gateway(static_cast<int>(call.gateway));
  broker_->publish({.topic = fmt::format("tmcl/v1/{}/call/{}/{}/{}", name, role, user, method),
                    .payload = std::move(payload),
                    .response_topic = fmt::format("tmcl/v1/reply/{}/{}/call", user, name),
                    .correlation = std::to_string(id)});
}

awaitable<void> FleetClient::await_answers() {
  const auto began = clock_.now();
  while (!calls_.empty() && clock_.now() - began < patience) co_await tmcld::rest(issue_interval);
}

void FleetClient::say_measured() const {
  std::vector<double> per_second;
  std::size_t most = 0;
  for (const auto& [topic, told] : telemetry_) {
    most = std::max(most, told.ever);
    per_second.push_back(static_cast<double>(told.measured) /
                         static_cast<double>(options_.measured_s));
  }
  std::ranges::sort(per_second);
  json::object telemetry{{"axes", per_second.size()},
                         {"most_since_wanted", most},
                         {"wanted_s", ms(clock_.now() - wanted_) / 1000}};
  if (!per_second.empty()) {
    telemetry["least"] = per_second.front();
    telemetry["median"] = per_second[per_second.size() / 2];
    telemetry["most"] = per_second.back();
  }
  say({{"event", "measured"},
       {"telemetry", telemetry},
       {"read", quantiles(read_ms_)},
       {"nonce", quantiles(nonce_ms_)},
       {"move", quantiles(move_ms_)},
       {"nonce_and_move", quantiles(nonce_and_move_ms_)},
       {"late", late_},
       {"refused", refused_},
       {"refusal", refusal_},
       {"unanswered", calls_.size()}});
}

// ---- the stop of all ---------------------------------------------------------------------------

awaitable<void> FleetClient::stop_all() {
  const auto began = clock_.now();
  auto next = began;
  while (!all_are_stopped() && clock_.now() - began < patience) {
    if (clock_.now() >= next) {
      publish_stops();
      next += stop_interval;
    }
    co_await tmcld::rest(std::chrono::milliseconds(1));
  }
  std::size_t axes = 0;
  for (const auto& [name, gateway] : gateways_) axes += gateway.stopped.size();
  const auto away =
      std::ranges::count_if(gateways_, [](const auto& one) { return one.second.is_away; });
  say({{"event", "stopped"},
       {"began", seconds_of(began)},
       {"took_ms", ms(clock_.now() - began)},
       {"axes", axes},
       {"away", away},
       {"rounds", stop_rounds_}});
}

/// To all at first, then to those of which something is missing, as tmclctl does.
void FleetClient::publish_stops() {
  if (stop_rounds_++ == 0) return publish_stop("all");
  for (const auto& [name, gateway] : gateways_)
    if (!is_stopped(gateway)) publish_stop(name);
}

void FleetClient::publish_stop(std::string_view level) {
  broker_->publish({.topic = fmt::format("tmcl/v1/{}/stop", level),
                    .qos = 1,
                    .response_topic = fmt::format("tmcl/v1/reply/{}/{}/stop", user, level)});
}

bool FleetClient::is_stopped(const Gateway& gateway) {
  return gateway.is_away || gateway.stopped.size() == axes_of_a_gateway;
}

bool FleetClient::all_are_stopped() const {
  return std::ranges::all_of(gateways_, [](const auto& one) { return is_stopped(one.second); });
}

// ---- messages ----------------------------------------------------------------------------------

void FleetClient::take(const tmclmqtt::Message& message) {
  const auto levels =
      tmclmqtt::levels_of(std::string_view(message.topic).substr(tmclmqtt::topic_root.size()));
  if (levels.size() == 4 && levels[0] == "reply")
    return levels[3] == "stop" ? take_stop(levels[2], message) : take_answer(message);
  if (levels.size() == 2 && levels[1] == "birth") return take_birth(levels[0], message);
  if (levels.size() != 3) return;
  auto& told = telemetry_[message.topic];
  ++told.ever;
  if (is_measuring_) ++told.measured;
}

void FleetClient::take_birth(std::string_view gateway, const tmclmqtt::Message& message) {
  const auto said = parsed(message.payload);
  auto& known = gateways_[std::string(gateway)];
  const auto* online = said.if_contains("online");
  const auto* axes = said.if_contains("axes");
  known.is_away = online == nullptr || !online->is_bool() || !online->get_bool();
  known.has_axes = axes != nullptr && axes->is_array() &&
                   axes->get_array().size() == static_cast<std::size_t>(axes_of_a_gateway);
}

void FleetClient::take_answer(const tmclmqtt::Message& message) {
  std::uint64_t id = 0;
  std::from_chars(message.correlation.data(),
                  message.correlation.data() + message.correlation.size(), id);
  auto found = calls_.extract(id);
  if (found.empty()) return;
  const auto& call = found.mapped();
  const auto now = clock_.now();
  const auto answer = parsed(message.payload);
  if (!answer.contains("result")) {
    const bool is_late = message.payload.find("\"stale_") != std::string::npos;
    ++(is_late ? late_ : refused_);
    if (!is_late) refusal_ = message.payload;
    return;
  }
  // Of plain clients, calls are measured where there are no others.
  const bool counts = is_measuring_ && (options_.real == 0 || call.gateway < options_.real);
  if (counts && call.kind == Kind::read) read_ms_.push_back(ms(now - call.sent));
  if (counts && call.kind == Kind::nonce) nonce_ms_.push_back(ms(now - call.sent));
  if (counts && call.kind == Kind::move) {
    move_ms_.push_back(ms(now - call.sent));
    nonce_and_move_ms_.push_back(ms(now - call.began));
  }
  if (call.kind == Kind::nonce) end_move_with(call, answer);
}

void FleetClient::take_stop(std::string_view gateway, const tmclmqtt::Message& message) {
  const auto answer = parsed(message.payload);
  const auto* result = answer.if_contains("result");
  const auto* stopped = result != nullptr && result->is_object()
                            ? result->get_object().if_contains("stopped")
                            : nullptr;
  if (stopped == nullptr || !stopped->is_array()) return;
  auto& known = gateways_[std::string(gateway)];
  for (const auto& one : stopped->get_array())
    if (one.is_object()) known.stopped.insert(text_of(one.get_object(), "axis"));
}

}  // namespace tmclfleet

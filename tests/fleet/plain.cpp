#include "fleet/plain.hpp"

#include <chrono>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "async/rest.hpp"
#include "async/spawn.hpp"
#include "fleet/names.hpp"

namespace tmclfleet {
namespace {

using boost::asio::awaitable;
using tmclmqtt::Broker;

constexpr auto telemetry_interval = std::chrono::milliseconds(500);

std::string birth_of_plain() {
  std::string axes;
  for (int axis = 0; axis < axes_of_a_gateway; ++axis)
    axes += fmt::format("{}\"{}\"", axis == 0 ? "" : ",", name_of_axis(axis));
  return R"({"online":true,"epoch":"e","nonce_ttl_ms":2000,"tmcld":"none","axes":[)" + axes + "]}";
}

std::string stop_of_plain() {
  std::string stopped;
  for (int axis = 0; axis < axes_of_a_gateway; ++axis)
    stopped += fmt::format(R"({}{{"axis":"{}","milliseconds":1.234567}})", axis == 0 ? "" : ",",
                           name_of_axis(axis));
  return R"({"result":{"stopped":[)" + stopped + R"(],"failed":[]},"epoch":"e"})";
}

// As long as those of a gateway.
constexpr auto telemetry_text =
    R"({"position_microsteps":-1234567,"velocity_internal":1000,"velocity_pps":30517.578125,)"
    R"("position":null,"velocity":null,"position_reached":false})";

std::string answer_of_plain() {
  return fmt::format(R"({{"result":{{"text":"{}"}},"epoch":"e","nonce":"{}"}})",
                     std::string(500, '-'), std::string(32, '0'));
}

}  // namespace

PlainGateway::PlainGateway(boost::asio::io_context& context, tmcld::Workers& workers,
                           const FleetPlace& place, int number)
    : context_(context), workers_(workers), place_(place), name_(name_of_gateway(number)) {}

void PlainGateway::start() { tmcld::spawn(context_.get_executor(), serve(*this)); }

awaitable<std::shared_ptr<Broker>> PlainGateway::connect(std::string_view client) {
  auto options = place_.connection_of(name_, "plain-" + name_ + std::string(client));
  auto connecting = tmclmqtt::connect_to_broker(
      workers_, std::move(options), [this](const auto& message) { take(message); }, [] {});
  auto connected = co_await std::move(connecting);
  if (!connected) throw std::runtime_error("no broker: " + connected.error());
  co_return std::move(*connected);
}

awaitable<void> PlainGateway::serve(PlainGateway& gateway) {
  auto connecting = gateway.connect("-stop");
  gateway.stops_ = co_await std::move(connecting);
  gateway.stops_->subscribe({fmt::format("tmcl/v1/{}/stop", gateway.name_), 1});
  gateway.stops_->subscribe({"tmcl/v1/all/stop", 1});
  connecting = gateway.connect("");
  gateway.calls_ = co_await std::move(connecting);
  gateway.calls_->subscribe({fmt::format("tmcl/v1/{}/call/+/+/+", gateway.name_), 0});
  gateway.calls_->subscribe({fmt::format("tmcl/v1/{}/want/+", gateway.name_), 0});
  gateway.calls_->publish({.topic = fmt::format("tmcl/v1/{}/birth", gateway.name_),
                           .payload = birth_of_plain(),
                           .retained = true,
                           .qos = 1});
  co_await gateway.tell();
}

awaitable<void> PlainGateway::tell() {
  while (true) {
    co_await tmcld::rest(telemetry_interval);
    for (int axis = 0; is_wanted_ && axis < axes_of_a_gateway; ++axis)
      calls_->publish({.topic = fmt::format("tmcl/v1/{}/telemetry/{}", name_, name_of_axis(axis)),
                       .payload = telemetry_text});
  }
}

void PlainGateway::take(const tmclmqtt::Message& message) {
  if (message.topic.ends_with("/stop")) {
    stops_->publish(
        {.topic = fmt::format("tmcl/v1/reply/anna/{}/stop", name_), .payload = stop_of_plain()});
  } else if (message.topic.find("/want/") != std::string::npos) {
    is_wanted_ = true;
  } else {
    calls_->publish({.topic = message.response_topic,
                     .payload = answer_of_plain(),
                     .correlation = message.correlation});
  }
}

}  // namespace tmclfleet

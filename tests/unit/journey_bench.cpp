#include "unit/journey_bench.hpp"

#include <csignal>
#include <stdexcept>
#include <utility>

#include "async/spawn.hpp"
#include "log/log.hpp"

namespace tmcld::test {

JourneyBench::JourneyBench(std::string_view model, const std::string& of_axes,
                           const std::string& of_module) {
  std::signal(SIGPIPE, SIG_IGN);
  silence_log();
  wire.bench().add(*tmcl::find_model(model), tmcl::ModuleAddress{1});
  wire.bench().add(*tmcl::find_model("TMCM-1110"), tmcl::ModuleAddress{2});
  wire.on_request = [this](const tmcl::Request& request) {
    requests.push_back(request);
    if (on_request) on_request(request);
  };
  std::string text =
      "[daemon]\nsocket = \"/none\"\n[[bus]]\nname = \"line\"\n"
      "link = \"serial:/dev/none@115200\"\n";
  if (!of_module.empty()) text += "[[module]]\nbus = \"line\"\naddress = 1\n" + of_module;
  const auto add = [&](const std::string& name, int address, int motor) {
    text += "[[axis]]\nname = \"" + name +
            "\"\nbus = \"line\"\naddress = " + std::to_string(address) +
            "\nmotor = " + std::to_string(motor) + '\n' + of_axes;
  };
  add("x", 1, 0);
  add("y", 1, 1);
  add("z", 1, 2);
  add("far", 2, 0);
  GatewayOptions options;
  options.open_link = [this](const BusConfig&) { return wire.open(); };
  gateway =
      Gateway::create(context_.get_executor(), parse_config(text).value(), std::move(options));
  gateway->on_event([this](const GatewayEvent& event) { events.push_back(event); });
  gateway->start();
  time.run_for(std::chrono::seconds(1));
  requests.clear();
}

JourneyBench::~JourneyBench() {
  gateway->close();
  time.run_for(std::chrono::seconds(10));
}

JourneyBench::Pending JourneyBench::begin(std::string_view method, json::object params) {
  const auto result = std::make_shared<std::optional<Result<boost::json::object>>>();
  const json::object line{
      {"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", std::move(params)}};
  auto request = parse_request(json::serialize(line)).request;
  if (!request) throw std::logic_error(request.error().message);
  spawn(context_.get_executor(), carry_out(std::move(*request), result));
  time.settle();
  return result;
}

Result<boost::json::object> JourneyBench::end_of(const Pending& pending) {
  if (!time.run_while_not([&] { return pending->has_value(); }, std::chrono::hours(1)))
    throw std::runtime_error("no answer");
  return **pending;
}

boost::asio::awaitable<void> JourneyBench::carry_out(RpcRequest request, Pending into) {
  auto result = co_await dispatch(gateway, peer_, std::move(request));
  *into = std::move(result);
}

}  // namespace tmcld::test

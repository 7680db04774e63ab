/// A gateway and two simulated modules in virtual time: x, y and z are motors of one, far is of
/// the other.
#pragma once

#include <csignal>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "api/subscriptions.hpp"
#include "async/spawn.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "log/log.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/wire.hpp"

namespace tmcld::test {

namespace json = boost::json;

class JourneyBench {
 public:
  explicit JourneyBench(std::string_view model = "TMCM-3110", const std::string& of_axes = {}) {
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
    gateway->start();
    time.run_for(std::chrono::seconds(1));
    requests.clear();
  }
  ~JourneyBench() {
    gateway->close();
    time.run_for(std::chrono::seconds(10));
  }
  JourneyBench(const JourneyBench&) = delete;
  JourneyBench& operator=(const JourneyBench&) = delete;

  using Pending = std::shared_ptr<std::optional<RpcResult>>;
  Pending begin(std::string_view method, json::object params) {
    const auto result = std::make_shared<std::optional<RpcResult>>();
    const json::object line{
        {"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", std::move(params)}};
    auto request = parse_request(json::serialize(line));
    if (!request) throw std::logic_error(request.error().error.message);
    spawn(context_.get_executor(), carry_out(std::move(*request), result));
    time.settle();
    return result;
  }
  RpcResult end_of(const Pending& pending) {
    if (!time.run_while_not([&] { return pending->has_value(); }, std::chrono::hours(1)))
      throw std::runtime_error("no answer");
    return **pending;
  }
  RpcResult call(std::string_view method, json::object params) {
    return end_of(begin(method, std::move(params)));
  }
  std::int64_t get(std::string_view axis, int parameter) {
    return call("parameter.get", {{"axis", axis}, {"parameter", parameter}})
        .value()
        .at("value")
        .to_number<std::int64_t>();
  }
  std::int64_t position(std::string_view axis) { return get(axis, 1); }
  std::vector<tmcl::Request> sent(tmcl::Command command) const {
    std::vector<tmcl::Request> found;
    for (const auto& request : requests)
      if (request.command == command) found.push_back(request);
    return found;
  }

 private:
  class Listener final : public Peer {
   public:
    explicit Listener(std::vector<json::object>& news) : news_(&news) {}
    void notify(std::string_view method, json::object params) override {
      if (method == "notify_progress") news_->push_back(std::move(params));
    }
    bool is_gone() const override { return false; }
    Subscriptions& subscriptions() override { return subscriptions_; }

   private:
    std::vector<json::object>* news_;
    Subscriptions subscriptions_{[] {}};
  };

  boost::asio::awaitable<void> carry_out(RpcRequest request, Pending into) {
    auto result = co_await dispatch(gateway, peer_, std::move(request));
    *into = std::move(result);
  }

  boost::asio::io_context context_{1};

 public:
  tmcl::VirtualTime time{context_};

 private:
  Trace trace_;

 public:
  Wire wire{context_, "line", tmcl::Framing::serial, 1, {}, trace_};
  std::vector<tmcl::Request> requests;
  std::function<void(const tmcl::Request&)> on_request;
  std::vector<json::object> news;
  std::shared_ptr<Gateway> gateway;

 private:
  std::shared_ptr<Peer> peer_ = std::make_shared<Listener>(news);
};

}  // namespace tmcld::test

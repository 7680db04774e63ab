/// A gateway and two simulated modules in virtual time: x, y and z are motors of one, far is of
/// the other.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/json/serialize.hpp>

#include "api/dispatch.hpp"
#include "api/subscriptions.hpp"
#include "config/load.hpp"
#include "gateway/gateway.hpp"
#include "tmcl/virtual_time.hpp"
#include "world/wire.hpp"

namespace tmcld::test {

namespace json = boost::json;

class JourneyBench {
 public:
  /// `of_module`: of the first one, in the configuration.
  explicit JourneyBench(std::string_view model = "TMCM-3110", const std::string& of_axes = {},
                        const std::string& of_module = {});
  ~JourneyBench();
  JourneyBench(const JourneyBench&) = delete;
  JourneyBench& operator=(const JourneyBench&) = delete;

  using Pending = std::shared_ptr<std::optional<Result<json::object>>>;
  Pending begin(std::string_view method, json::object params);
  Result<json::object> end_of(const Pending& pending);
  Result<json::object> call(std::string_view method, json::object params) {
    return end_of(begin(method, std::move(params)));
  }
  std::int64_t get(std::string_view axis, int parameter) {
    return call("parameter.get", {{"axis", axis}, {"parameter", parameter}})
        .value()
        .at("value")
        .to_number<std::int64_t>();
  }
  std::int64_t position(std::string_view axis) { return get(axis, 1); }
  /// What its subscriptions have been told of since this was asked last.
  std::vector<json::object> states() {
    std::vector<json::object> told;
    while (auto state = peer_->subscriptions().take_pending()) told.push_back(std::move(*state));
    return told;
  }
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

  boost::asio::awaitable<void> carry_out(RpcRequest request, Pending into);

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
  std::vector<GatewayEvent> events;
  std::shared_ptr<Gateway> gateway;

 private:
  std::shared_ptr<Peer> peer_ = std::make_shared<Listener>(news);
};

}  // namespace tmcld::test

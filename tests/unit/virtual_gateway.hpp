/// A gateway in virtual time, on one bus in memory whose modules the test plays. A call takes no
/// time of the computer's, whatever it waits for.
#pragma once

#include <csignal>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <boost/asio/io_context.hpp>

#include "api/dispatch.hpp"
#include "api/subscriptions.hpp"
#include "async/spawn.hpp"
#include "tmcl/virtual_time.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

class VirtualGateway {
 public:
  explicit VirtualGateway(const std::string& toml = two_axes()) {
    silence_log();
    std::signal(SIGPIPE, SIG_IGN);
    wire.modules.emplace(std::uint8_t{1}, FakeModule(1));
    const auto config = parse_config("[daemon]\nsocket = \"/none\"\n" + toml);
    if (!config) throw std::runtime_error(config.error().front().message);
    GatewayOptions options;
    options.open_link = [this](const BusConfig&) {
      auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
      wire.plug_in(context_.get_executor(), ::dup(ends->second.descriptor()));
      return tmcl::Result<tmcl::Link>(std::move(ends->first));
    };
    gateway_ = Gateway::create(context_.get_executor(), *config, std::move(options));
    gateway_->start();
    time.run_for(std::chrono::seconds(1));
  }
  ~VirtualGateway() {
    gateway_->close();
    wire.unplug();
    time.settle();
  }
  VirtualGateway(const VirtualGateway&) = delete;
  VirtualGateway& operator=(const VirtualGateway&) = delete;

  /// Throws if it does not end within an hour.
  RpcResult call(std::string_view method, json::object params) {
    std::optional<RpcResult> result;
    spawn(context_.get_executor(), carry_out({1, find_method(method), std::move(params)}, result));
    if (!time.run_while_not([&] { return result.has_value(); }, std::chrono::hours(1)))
      throw std::runtime_error("no answer");
    return std::move(*result);
  }

  Gateway& gateway() { return *gateway_; }

 private:
  class NobodySubscribes final : public Peer {
   public:
    void notify(std::string_view, json::object) override {}
    bool is_gone() const override { return false; }
    Subscriptions& subscriptions() override { return subscriptions_; }

   private:
    Subscriptions subscriptions_{[] {}};
  };

  boost::asio::awaitable<void> carry_out(RpcRequest request, std::optional<RpcResult>& into) {
    auto result = co_await dispatch(gateway_, peer_, std::move(request));
    into = std::move(result);
  }

  boost::asio::io_context context_{1};
  std::shared_ptr<Peer> peer_ = std::make_shared<NobodySubscribes>();
  std::shared_ptr<Gateway> gateway_;

 public:
  tmcl::VirtualTime time{context_};
  FakeWire wire;
};

}  // namespace tmcld::test

/// A gateway in virtual time, on one bus in memory whose modules the test plays. A call takes no
/// time of the computer's, whatever it waits for.
#pragma once

#include <csignal>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

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
    wire.delay = {};
    const auto config = parse_config("[daemon]\nsocket = \"/none\"\n" + toml);
    if (!config) throw std::runtime_error(config.error().front().message);
    GatewayOptions options;
    options.open_link = [this](const BusConfig&) {
      auto ends = tmcl::Link::memory_pair(tmcl::Framing::serial);
      wire.plug_in(context_.get_executor(), ::dup(ends->second.descriptor()));
      return tmcl::Result<tmcl::Link>(std::move(ends->first));
    };
    options.audit = [this](const AuditEntry& entry) { audited.push_back(entry.text); };
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
    return std::move(call_together(1, method, std::move(params)).front());
  }
  /// The same call, so many times at once.
  std::vector<RpcResult> call_together(std::size_t count, std::string_view method,
                                       const json::object& params) {
    std::vector<RpcResult> results;
    for (std::size_t i = 0; i < count; ++i) begin_call(method, params, results);
    if (!time.run_while_not([&] { return results.size() == count; }, std::chrono::hours(1)))
      throw std::runtime_error("no answer");
    return results;
  }

  /// What comes back is added to the results, which outlive it.
  void begin_call(std::string_view method, const json::object& params,
                  std::vector<RpcResult>& into) {
    RpcRequest request{1, find_method(method), params};
    request.sent_at = take_sent_at(*request.method, request.params).value();
    spawn(context_.get_executor(), carry_out(std::move(request), into));
  }

  Gateway& gateway() { return *gateway_; }

  Caller caller;  ///< Who makes the calls,
  Client client;  ///< over which connection.
  std::vector<std::string> audited;

 private:
  class NobodySubscribes final : public Peer {
   public:
    explicit NobodySubscribes(const VirtualGateway& bench) : bench_(bench) {}
    void notify(std::string_view, json::object) override {}
    bool is_gone() const override { return false; }
    Subscriptions& subscriptions() override { return subscriptions_; }
    Client client() const override { return bench_.client; }
    Caller caller() const override { return bench_.caller; }

   private:
    const VirtualGateway& bench_;
    Subscriptions subscriptions_{[] {}};
  };

  boost::asio::awaitable<void> carry_out(RpcRequest request, std::vector<RpcResult>& into) {
    auto result = co_await dispatch(gateway_, peer_, std::move(request));
    into.push_back(std::move(result));
  }

  boost::asio::io_context context_{1};
  std::shared_ptr<Peer> peer_ = std::make_shared<NobodySubscribes>(*this);
  std::shared_ptr<Gateway> gateway_;

 public:
  tmcl::VirtualTime time{context_};
  FakeWire wire;
};

}  // namespace tmcld::test

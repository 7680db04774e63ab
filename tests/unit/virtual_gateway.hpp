/// A gateway in virtual time, on one bus in memory whose modules the test plays. A call takes no
/// time of the computer's, whatever it waits for.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "api/dispatch.hpp"
#include "api/subscriptions.hpp"
#include "async/slept.hpp"
#include "tmcl/virtual_time.hpp"
#include "unit/daemon_fixture.hpp"

namespace tmcld::test {

class VirtualGateway {
 public:
  explicit VirtualGateway(const std::string& toml = two_axes());
  ~VirtualGateway();
  VirtualGateway(const VirtualGateway&) = delete;
  VirtualGateway& operator=(const VirtualGateway&) = delete;

  /// Throws if it does not end within an hour.
  Result<boost::json::object> call(std::string_view method, json::object params);
  /// The same call, so many times at once.
  std::vector<Result<boost::json::object>> call_together(std::size_t count, std::string_view method,
                                                         const json::object& params);
  /// What comes back is added to the results, which outlive it.
  void begin_call(std::string_view method, const json::object& params,
                  std::vector<Result<boost::json::object>>& into);

  Gateway& gateway() { return *gateway_; }

  Caller caller;  ///< Who makes the calls,
  Client client;  ///< over which connection.
  std::vector<std::string> audited;

 private:
  class NobodySubscribes final : public Peer {
   public:
    NobodySubscribes(const VirtualGateway& bench, Client client)
        : bench_(bench), client_(std::move(client)) {}
    void notify(std::string_view, json::object) override {}
    bool is_gone() const override { return false; }
    Subscriptions& subscriptions() override { return subscriptions_; }
    Client client() const override { return client_; }
    Caller caller() const override { return bench_.caller; }

   private:
    const VirtualGateway& bench_;
    Client client_;
    Subscriptions subscriptions_{[] {}};
  };

  /// The connection of `client`.
  std::shared_ptr<Peer> peer();
  boost::asio::awaitable<void> carry_out(std::shared_ptr<Peer> peer, RpcRequest request,
                                         std::vector<Result<boost::json::object>>& into);

  boost::asio::io_context context_{1};
  /// By their clients: a call runs later than it is begun, when `client` may be another.
  std::map<std::uint64_t, std::shared_ptr<Peer>> peers_;
  std::shared_ptr<Gateway> gateway_;

 public:
  /// As a computer does: the time stays as it is.
  void let_computer_sleep(tmcl::Duration duration) {
    boost::asio::use_service<VirtualSleep>(context_).slept += duration;
  }

  tmcl::VirtualTime time{context_};
  FakeWire wire;
};

}  // namespace tmcld::test

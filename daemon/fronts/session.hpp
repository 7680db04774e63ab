/// One client, whatever it is connected by: takes its messages, runs its requests side by side, and
/// gives what they come to. A front derives its connection, which carries messages as it does.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "api/configuration_keeper.hpp"
#include "api/notifications.hpp"
#include "api/page_place.hpp"
#include "api/peer.hpp"
#include "api/relay.hpp"
#include "api/request.hpp"
#include "api/token_keeper.hpp"
#include "async/wake.hpp"
#include "fronts/client_rights.hpp"
#include "fronts/front_share.hpp"
#include "fronts/outbox.hpp"
#include "fronts/request_lanes.hpp"
#include "gateway/authority/client_list.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// Between two checks that a client which sends nothing is still connected.
constexpr tmcl::Duration hang_up_check_interval = std::chrono::milliseconds(200);

/// Whatever a client does, it costs other clients nothing, and no more memory than the bounds here
/// and in the outbox allow.
class Session : public Peer,
                public TokenKeeper,
                public PagePlace,
                public ConfigurationPlace,
                public Relay,
                public std::enable_shared_from_this<Session> {
 public:
  enum class Serves : std::uint8_t { all, stops };

  struct Options {
    std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>();
    /// Worked out for each call: the configuration may have changed since it connected.
    std::function<Caller()> caller = [] { return Caller{}; };
    std::string name{};           ///< As others are told of it.
    std::string door = "socket";  ///< As in ConnectedClient, as are these.
    std::string address{};
    std::string token{};
    Serves serves = Serves::all;
    std::function<void()> on_closed = [] {};
  };

  Session(const boost::asio::any_io_executor& executor, std::shared_ptr<Gateway> gateway,
          Options options);

  /// Takes no more requests, and closes when everything in progress has been answered.
  void finish();
  void close();
  bool is_closed() const { return closed_; }
  bool has_calls_in_flight() const { return !requests_.are_empty(); }
  /// Something of what a front has taken may wait there.
  virtual bool has_output() const { return !outbox_.empty() || notifications_.has_pending(); }
  /// Whether its client may do less than when this was asked last; the log is told. Its connection
  /// must then be closed, so that what it has asked for and was not sent yet moves nothing.
  bool has_lost_rights();
  /// Whether something turns, or is leased, until this connection ends.
  bool holds_axes() const;

  void notify(std::string_view method, boost::json::object params) override;
  bool is_gone() const override { return closed_; }
  Subscriptions& subscriptions() override { return notifications_.subscriptions(); }
  Client client() const override { return client_; }
  Caller caller() const override { return rights_.caller(); }
  std::optional<Error> speak_for(RelayedUser user) override;
  const std::shared_ptr<Tokens>& tokens() const override { return share_->tokens; }
  const std::vector<std::string>& page_addresses() const override { return share_->page_addresses; }
  const std::shared_ptr<ConfigurationKeeper>& configuration() const override {
    return share_->configuration;
  }

 protected:
  /// The first message, where a connection has one.
  void greet();
  /// A message of the client; nothing: one that was too long.
  void take(std::optional<std::string_view> message);
  /// The next one to the client: answers first.
  std::optional<std::string> next_message();
  std::optional<std::string> next_answer() { return outbox_.take_answer(); }
  /// Until there is something to write. False at the end of everything.
  boost::asio::awaitable<bool> wait_for_output();
  void wake_output() { output_.notify(); }
  Wake& output() { return output_; }
  bool is_finishing() const { return finishing_; }
  bool has_waiting_requests() const { return requests_.has_waiting(); }
  /// Memory is missing, or there is a bug: costs this client its connection, and other clients
  /// anything.
  void fail(const std::exception_ptr& failure);
  const boost::asio::any_io_executor& executor() const { return executor_; }
  Gateway& gateway() { return *gateway_; }

  virtual void on_answer() { output_.notify(); }
  /// Ends the connection, after everything else has ended.
  virtual void disconnect() = 0;

 private:
  static boost::asio::awaitable<void> serve(std::shared_ptr<Session> self, RpcRequest request);

  ConnectedClient look() const;
  void take_message(std::optional<std::string_view> message);
  void log_call(const std::string& text, const Result<boost::json::object>& result,
                tmcl::Duration took);
  void begin(RpcRequest request);
  void start_serving(RpcRequest request);
  void start_waiting();
  void answer(const boost::json::value& id, const Result<boost::json::object>& result,
              tmcl::Effect effect = tmcl::Effect::reads);

  boost::asio::any_io_executor executor_;
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<FrontShare> share_;
  Serves serves_;
  std::function<void()> on_closed_;
  ClientRights rights_;
  Client client_;
  ConnectedClient came_;  ///< Its door, address and token.
  Outbox outbox_;
  Wake output_;
  Notifications notifications_;
  RequestLanes requests_;
  bool finishing_ = false;
  bool closed_ = false;
  ClientList::Entry entry_;
};

}  // namespace tmcld

/// One client on the unix socket: reads its lines, runs its requests side by side, writes what
/// they give.
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "api/notifications.hpp"
#include "api/peer.hpp"
#include "api/request.hpp"
#include "async/wake.hpp"
#include "fronts/line_buffer.hpp"
#include "fronts/outbox.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

/// How many requests of one client may be in progress. Stops have a number of their own, so that
/// no flood of other calls keeps one out.
constexpr std::size_t max_requests_in_flight = 64;
/// While more of answers waits to be written, requests that only read wait, too: their answers are
/// the long ones, and nobody else waits for them. Whatever moves or stops something has its order.
constexpr std::size_t reads_wait_at_unsent_bytes = 128U * 1024U;

/// Whatever a client does, it costs nobody else anything, and no more memory than the bounds here
/// and in the outbox allow.
class Session final : public Peer, public std::enable_shared_from_this<Session> {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;

  enum class Serves : std::uint8_t { all, stops };

  Session(Socket socket, std::shared_ptr<Gateway> gateway, Serves serves,
          std::function<void()> on_closed);

  /// Says hello and begins to read; returns at once.
  void start();
  /// Reads no more, and closes when everything in progress has been answered.
  void finish();
  void close();
  bool has_calls_in_flight() const { return calls_in_flight_ > 0 || stops_in_flight_ > 0; }

  void notify(std::string_view method, boost::json::object params) override;
  bool is_gone() const override { return closed_; }
  Subscriptions& subscriptions() override { return notifications_.subscriptions(); }
  Client client() const override { return client_; }
  Caller caller() const override { return caller_; }

 private:
  static boost::asio::awaitable<void> read(std::shared_ptr<Session> self);
  static boost::asio::awaitable<void> write(std::shared_ptr<Session> self);
  static boost::asio::awaitable<void> serve(std::shared_ptr<Session> self, RpcRequest request);

  boost::asio::awaitable<void> outlive_input();
  bool has_hung_up();
  void on_line(std::optional<std::string_view> line);
  void begin(RpcRequest request);
  bool must_wait(const RpcRequest& request) const;
  void start_serving(RpcRequest request);
  void start_waiting();
  void answer(const boost::json::value& id, RpcResult result,
              tmcl::Effect effect = tmcl::Effect::reads);
  /// Memory is missing, or there is a bug: costs this client its connection, and nobody else
  /// anything.
  void fail(const std::exception_ptr& failure);
  bool has_output() const;
  std::string take_output();
  void send_answers();
  void write_now();

  Socket socket_;
  std::shared_ptr<Gateway> gateway_;
  Serves serves_;
  std::function<void()> on_closed_;
  Caller caller_;
  Client client_;
  LineBuffer lines_;
  Outbox outbox_;
  std::string batch_;  ///< What is being written.
  bool is_writing_ = false;
  bool is_taking_input_ = false;
  Wake output_;
  Wake input_ended_;
  Notifications notifications_;
  std::deque<RpcRequest> waiting_;  ///< In progress as far as clients are concerned.
  std::size_t calls_in_flight_ = 0;
  std::size_t stops_in_flight_ = 0;
  bool finishing_ = false;
  bool closed_ = false;
};

}  // namespace tmcld

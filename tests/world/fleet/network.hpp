/// Connections to a broker in the same process, each a queue with a delay both ways, which may
/// stall, break or fall silent; and the broker's computer, which may stand still or start again.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>

#include "broker/broker.hpp"
#include "support/random.hpp"
#include "tmcl/timer.hpp"
#include "world/fleet/sim_broker.hpp"

namespace tmclmqtt::test {

using Random = tmcl::test::Random<>;

/// What comes to a client of the broker.
struct Delivery {
  enum class Kind : std::uint8_t { let_in, message, acknowledged, closed };
  Kind kind = Kind::message;
  Message message{};
  std::string why{};
  std::uint64_t packet = 0;  ///< Of what was published with QoS 1.
  Reason reason = Reason::success;
};

class Network;

/// One way of a connection.
struct Pipe {
  tmcl::Duration latency{};
  tmcl::TimePoint free_at{};
  std::size_t on_the_way = 0;
};

/// A connection, from its client's end.
class Connection final : public Subscriber, public std::enable_shared_from_this<Connection> {
 public:
  using OnDelivery = std::function<void(Delivery)>;
  /// What a client writes without waiting until it has gone out.
  static constexpr std::size_t most_unsent = 16;

  Connection(Network& network, OnDelivery on_delivery);

  void connect(ConnectPacket packet);
  void subscribe(const std::string& filter, int qos);
  void publish(const Publication& publication, std::uint64_t packet = 0);
  void disconnect();
  /// Its end has gone, without a word.
  void abandon();
  bool has_room() const { return up_.on_the_way < most_unsent; }
  std::function<void()> on_room = [] {};

  // ---- what happens to it ----
  void stall_up(tmcl::Duration duration);
  void stall_down(tmcl::Duration duration);
  /// Both ends see it; what is on the way still comes, or does not.
  void cut(bool loses);
  /// Neither end sees it until its patience is over.
  void fall_silent();
  bool is_open() const { return !is_gone_; }
  /// Nothing comes through it now, one way at least.
  bool is_disturbed() const;

  void on_message(Message message, int qos) override;
  void on_close(std::string why) override;

 private:
  void send_up(std::function<void()> arrive);
  void send_down(Delivery delivery);

  Network& network_;
  OnDelivery on_delivery_;
  Pipe up_;
  Pipe down_;
  std::string client_id_;
  bool is_silent_ = false;
  bool is_gone_ = false;  ///< For its client.
};

class Network {
 public:
  /// When one of two ends sees that nothing comes any more: one and a half of ten seconds.
  static constexpr tmcl::Duration patience = std::chrono::seconds(15);

  Network(boost::asio::any_io_executor executor, AccessList access, Random random)
      : executor_(std::move(executor)), broker_(std::move(access)), random_(random) {}

  std::shared_ptr<Connection> open(Connection::OnDelivery on_delivery);
  SimBroker& broker() { return broker_; }
  tmcl::TimePoint now() const { return tmcl::now(executor_); }
  void later(tmcl::Duration duration, std::function<void()> then);
  /// In the order of their coming, and when the broker does not stand still.
  void at_broker(std::function<void()> then);
  void freeze_broker(tmcl::Duration duration);
  /// It is away for so long.
  void restart_broker(bool keeps, tmcl::Duration duration);
  bool is_there() const { return now() >= away_until_; }
  bool is_frozen() const { return now() < frozen_until_; }
  tmcl::Duration draw_latency();
  /// Of all kinds of messages: told twice now and then.
  bool doubles = false;
  bool draws_double() { return doubles && random_.one_in(8); }

 private:
  void run_broker();

  boost::asio::any_io_executor executor_;
  SimBroker broker_;
  Random random_;
  std::deque<std::function<void()>> waiting_;
  tmcl::TimePoint frozen_until_{};
  tmcl::TimePoint away_until_{};
  std::optional<tmcl::TimePoint> due_{};  ///< When the broker has something to do by itself.
};

/// A function such as connect_to_broker(), for a program with that executor. It is told what its
/// program reads.
struct SimConnectOptions {
  std::string user;
  /// In the turn in which the program reads it; may change it.
  std::function<void(const BrokerOptions& by, Message& message)> on_read;
  std::function<void(const BrokerOptions& by, const Publication& publication)> on_publish;
  /// Of each connection that is let in.
  std::function<void(const BrokerOptions& by, std::shared_ptr<Connection>)> on_connected;
};
ConnectToBroker connect_to(Network& network, boost::asio::any_io_executor executor,
                           SimConnectOptions options);

}  // namespace tmclmqtt::test

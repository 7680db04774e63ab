#include "world/fleet/network.hpp"

#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>

#include "async/wake.hpp"

namespace tmclmqtt::test {
namespace {

using boost::asio::awaitable;

constexpr auto let_in_timeout = std::chrono::seconds(5);
constexpr auto will_delay = std::chrono::seconds(1);

}  // namespace

// ---- the network -------------------------------------------------------------------------------

std::shared_ptr<Connection> Network::open(Connection::OnDelivery on_delivery) {
  return std::make_shared<Connection>(*this, std::move(on_delivery));
}

void Network::later(tmcl::Duration duration, std::function<void()> then) {
  const auto timer = std::make_shared<tmcl::Timer>(executor_);
  timer->expires_after(duration);
  timer->async_wait([timer, then = std::move(then)](const auto& error) {
    if (!error) then();
  });
}

tmcl::Duration Network::draw_latency() {
  return std::chrono::microseconds(random_.between(200, 20'000));
}

void Network::at_broker(std::function<void()> then) {
  if (is_frozen() || !waiting_.empty()) {
    waiting_.push_back(std::move(then));
    return;
  }
  then();
  run_broker();
}

void Network::run_broker() {
  broker_.run_due(now());
  const auto next = broker_.next_due();
  if (!next || (due_ && *due_ <= *next)) return;
  due_ = next;
  later(*next - now(), [this] {
    due_.reset();
    at_broker([] {});
  });
}

void Network::freeze_broker(tmcl::Duration duration) {
  if (is_frozen()) return;
  frozen_until_ = now() + duration;
  later(duration, [this] {
    while (!waiting_.empty() && !is_frozen()) {
      auto next = std::move(waiting_.front());
      waiting_.pop_front();
      next();
    }
    run_broker();
  });
}

void Network::restart_broker(bool keeps, tmcl::Duration duration) {
  away_until_ = now() + duration;
  // They hold connections that the broker knows until it has begun anew.
  const auto unheard = std::exchange(waiting_, {});
  broker_.restart(keeps, now());
  later(duration, [this] { run_broker(); });
}

// ---- a connection ------------------------------------------------------------------------------

Connection::Connection(Network& network, OnDelivery on_delivery)
    : network_(network), on_delivery_(std::move(on_delivery)) {
  up_.latency = network_.draw_latency();
  down_.latency = network_.draw_latency();
}

void Connection::send_up(std::function<void()> arrive) {
  const auto now = network_.now();
  up_.free_at = std::max(up_.free_at, now + up_.latency);
  ++up_.on_the_way;
  network_.later(up_.free_at - now,
                 [self = shared_from_this(), arrive = std::move(arrive)]() mutable {
                   const bool had_room = self->has_room();
                   --self->up_.on_the_way;
                   if (!had_room && self->has_room()) self->on_room();
                   if (self->is_silent_) return;
                   if (!self->network_.is_there()) return self->on_close("connection reset");
                   self->network_.at_broker(std::move(arrive));
                 });
}

void Connection::send_down(Delivery delivery) {
  const auto now = network_.now();
  down_.free_at = std::max(down_.free_at, now + down_.latency);
  network_.later(down_.free_at - now,
                 [self = shared_from_this(), delivery = std::move(delivery)]() mutable {
                   if (self->is_silent_ || self->is_gone_) return;
                   if (delivery.kind == Delivery::Kind::closed) self->is_gone_ = true;
                   self->on_delivery_(std::move(delivery));
                 });
}

void Connection::connect(ConnectPacket packet) {
  client_id_ = packet.client_id;
  if (!network_.is_there()) return on_close("connection refused");
  send_up([self = shared_from_this(), packet = std::move(packet)] {
    if (self->is_gone_) return;
    self->send_down({.kind = Delivery::Kind::let_in});
    self->network_.broker().connect(*self, packet, self->network_.now());
  });
}

void Connection::subscribe(const std::string& filter, int qos) {
  if (is_gone_) return;
  send_up([self = shared_from_this(), filter, qos] {
    self->network_.broker().subscribe(*self, filter, qos, self->network_.now());
  });
}

void Connection::publish(const Publication& publication, std::uint64_t packet) {
  if (is_gone_) return;
  send_up([self = shared_from_this(), publication, packet] {
    const auto reason = self->network_.broker().publish(*self, publication, self->network_.now());
    if (publication.qos > 0 && packet != 0)
      self->send_down({.kind = Delivery::Kind::acknowledged, .packet = packet, .reason = reason});
  });
}

void Connection::disconnect() {
  if (std::exchange(is_gone_, true)) return;
  send_up([self = shared_from_this()] {
    self->network_.broker().disconnect(*self, self->network_.now());
  });
}

void Connection::abandon() {
  if (std::exchange(is_gone_, true)) return;
  send_up(
      [self = shared_from_this()] { self->network_.broker().lose(*self, self->network_.now()); });
}

void Connection::on_message(Message message, int qos) {
  if (qos > 0 && network_.draws_double()) send_down({.message = message});
  send_down({.message = std::move(message)});
}

void Connection::on_close(std::string why) {
  send_down({.kind = Delivery::Kind::closed, .why = std::move(why)});
}

void Connection::stall_up(tmcl::Duration duration) {
  up_.free_at = std::max(up_.free_at, network_.now() + duration);
}
void Connection::stall_down(tmcl::Duration duration) {
  down_.free_at = std::max(down_.free_at, network_.now() + duration);
}

bool Connection::is_disturbed() const {
  const auto soon = network_.now() + std::chrono::milliseconds(50);
  return is_silent_ || up_.free_at > soon || down_.free_at > soon;
}

void Connection::cut(bool loses) {
  if (is_gone_) return;
  if (loses) {
    is_gone_ = true;
    on_delivery_({.kind = Delivery::Kind::closed, .why = "connection lost"});
  } else {
    on_close("connection lost");
  }
  send_up(
      [self = shared_from_this()] { self->network_.broker().lose(*self, self->network_.now()); });
}

void Connection::fall_silent() {
  if (is_gone_ || std::exchange(is_silent_, true)) return;
  network_.later(Network::patience, [self = shared_from_this()] {
    self->network_.at_broker([self] { self->network_.broker().lose(*self, self->network_.now()); });
    if (std::exchange(self->is_gone_, true)) return;
    self->on_delivery_({.kind = Delivery::Kind::closed, .why = "keep-alive timeout"});
  });
}

// ---- for a program -----------------------------------------------------------------------------

namespace {

/// A Broker whose messages lie in a socket until its program reads them, one in a turn.
class SimConnection final : public Broker, public std::enable_shared_from_this<SimConnection> {
 public:
  SimConnection(boost::asio::any_io_executor executor, BrokerOptions options, OnMessage on_message,
                std::function<void()> on_room, const SimConnectOptions& sim)
      : executor_(std::move(executor)),
        options_(std::move(options)),
        on_message_(std::move(on_message)),
        on_room_(std::move(on_room)),
        sim_(sim),
        changed_(executor_) {}
  SimConnection(const SimConnection&) = delete;
  SimConnection& operator=(const SimConnection&) = delete;
  ~SimConnection() override {
    if (connection_) connection_->abandon();
  }

  void open(Network& network) {
    connection_ = network.open([weak = weak_from_this()](Delivery delivery) {
      if (const auto self = weak.lock()) self->arrive(std::move(delivery));
    });
    connection_->on_room = [weak = weak_from_this()] {
      const auto self = weak.lock();
      if (!self) return;
      boost::asio::post(self->executor_, [self] {
        if (!self->lost_) self->on_room_();
      });
    };
    connection_->connect({.client_id = options_.client_id,
                          .user = sim_.user,
                          .will = options_.will,
                          .will_delay = will_delay,
                          .max_packet_bytes = options_.max_packet_bytes});
  }
  awaitable<std::string> wait_until_let_in() {
    const auto deadline = tmcl::now(executor_) + let_in_timeout;
    while (!is_let_in_ && !lost_ && tmcl::now(executor_) < deadline)
      co_await changed_.wait_until(deadline);
    if (!is_let_in_) lose("it accepts the connection and then says nothing");
    if (is_let_in_ && !lost_) sim_.on_connected(options_, connection_);
    co_return lost_ ? why_ : std::string();
  }

  void subscribe(const Subscribed& to) override {
    if (!lost_) connection_->subscribe(to.filter, to.qos);
  }
  Sent publish(const Publication& publication) override {
    if (lost_) return Sent::no;
    if (publication.payload.size() > ConnectPacket::max_packet_bytes_of_broker)
      return Sent::too_long;
    sim_.on_publish(options_, publication);
    connection_->publish(publication);
    return Sent::yes;
  }
  bool has_room() const override { return !lost_ && connection_->has_room(); }
  awaitable<std::string> end() override {
    while (!lost_) co_await changed_.wait();
    co_return why_;
  }
  void disconnect() override {
    if (lost_) return;
    connection_->disconnect();
    lose("ended");
  }

 private:
  void arrive(Delivery delivery) {
    in_socket_.push_back(std::move(delivery));
    if (!std::exchange(is_reading_, true)) read_later();
  }
  void read_later() {
    boost::asio::post(executor_, [self = shared_from_this()] { self->read(); });
  }
  void read() {
    auto next = std::move(in_socket_.front());
    in_socket_.pop_front();
    is_reading_ = !in_socket_.empty();
    if (is_reading_) read_later();
    if (lost_) return;
    if (next.kind == Delivery::Kind::let_in) {
      is_let_in_ = true;
      changed_.notify();
    } else if (next.kind == Delivery::Kind::closed) {
      lose(next.why);
    } else if (next.kind == Delivery::Kind::message) {
      sim_.on_read(options_, next.message);
      if (!next.message.topic.empty()) on_message_(std::move(next.message));
    }
  }
  void lose(std::string why) {
    if (std::exchange(lost_, true)) return;
    why_ = std::move(why);
    connection_->abandon();
    changed_.notify();
  }

  boost::asio::any_io_executor executor_;
  BrokerOptions options_;
  OnMessage on_message_;
  std::function<void()> on_room_;
  const SimConnectOptions& sim_;
  tmcld::Wake changed_;
  std::shared_ptr<Connection> connection_;
  std::deque<Delivery> in_socket_;
  bool is_reading_ = false;
  bool is_let_in_ = false;
  bool lost_ = false;
  std::string why_;
};

awaitable<Connected> connect_simulated(Network& network, boost::asio::any_io_executor executor,
                                       std::shared_ptr<const SimConnectOptions> sim,
                                       BrokerOptions options, Broker::OnMessage on_message,
                                       std::function<void()> on_room) {
  const auto connection = std::make_shared<SimConnection>(
      executor, std::move(options), std::move(on_message), std::move(on_room), *sim);
  connection->open(network);
  auto letting_in = connection->wait_until_let_in();
  const auto problem = co_await std::move(letting_in);
  if (!problem.empty()) co_return tl::unexpected(problem);
  std::shared_ptr<Broker> connected = connection;
  co_return connected;
}

}  // namespace

ConnectToBroker connect_to(Network& network, boost::asio::any_io_executor executor,
                           SimConnectOptions options) {
  auto sim = std::make_shared<const SimConnectOptions>(std::move(options));
  return [&network, executor = std::move(executor), sim](
             BrokerOptions by, Broker::OnMessage on_message, std::function<void()> on_room) {
    return connect_simulated(network, executor, sim, std::move(by), std::move(on_message),
                             std::move(on_room));
  };
}

}  // namespace tmclmqtt::test

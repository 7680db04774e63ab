/// A user of a gateway on a broker: keeps its connection, knows the gateway's epoch and has nonces.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <boost/json/object.hpp>

#include "async/wake.hpp"
#include "world/fleet/fleet_ledger.hpp"
#include "world/fleet/network.hpp"

namespace tmcld::test {

namespace json = boost::json;
using tmclmqtt::Publication;
using tmclmqtt::test::Connection;
using tmclmqtt::test::Delivery;
using tmclmqtt::test::Network;
using tmclmqtt::test::Reason;

/// How a call is published; what is empty is as the protocol wants it.
struct Form {
  std::string payload{};
  std::string response_topic{};
  std::string correlation{};
  bool retained = false;
  int qos = 0;
  std::optional<std::uint32_t> expiry_s{};
};

struct Nonce {
  std::string text;
  tmcl::TimePoint came;
};

class FleetUser : public std::enable_shared_from_this<FleetUser> {
 public:
  FleetUser(Network& network, const boost::asio::any_io_executor& executor, std::string name,
            std::string role)
      : network_(network),
        executor_(executor),
        name_(std::move(name)),
        role_(std::move(role)),
        came_(executor) {}

  static constexpr auto gateway = "hall";

  const std::string& name() const { return name_; }
  void start() { connect(); }
  void end();

  /// Gives the correlation data. Without a connection it waits for the next one if it is QoS 1.
  std::string publish(const std::string& method, const json::object& said, Form form = {});
  void publish(Publication publication);
  Publication publication_of(const std::string& method, const json::object& said, Form form);
  /// Until there is an answer; nothing: it did not come in time.
  boost::asio::awaitable<std::optional<json::object>> answer_to(std::string correlation,
                                                                tmcl::Duration patience);
  std::string next_correlation() { return name_ + "-" + std::to_string(++last_correlation_); }
  std::string reply_topic() const { return "tmcl/v1/reply/" + name_ + "/" + gateway + "/x"; }
  std::string call_topic(const std::string& method) const {
    return std::string("tmcl/v1/") + gateway + "/call/" + role_ + '/' + name_ + '/' + method;
  }

  bool is_connected() const { return connection_ && is_let_in_; }
  const std::shared_ptr<Connection>& connection() const { return connection_; }
  const std::string& epoch() const { return epoch_; }
  bool gateway_is_online() const { return online_; }
  /// The newest one, which is used up.
  std::optional<Nonce> take_nonce();
  /// As the protocol wants it, if there is a nonce.
  json::object with_epoch_and_nonce(json::object params, const std::string& nonce) const {
    return {{"params", std::move(params)}, {"epoch", epoch_}, {"nonce", nonce}};
  }

  /// What is wrong with what came.
  std::function<void(std::string)> complain = [](const std::string&) {};
  /// By correlation data: answers, and how often the gateway has read what they answer.
  std::map<std::string, int> answers;
  std::map<std::string, int> read;
  std::map<Reason, int> reasons;
  std::set<std::string> old_epochs;
  std::deque<Nonce> used_nonces;
  std::size_t answered = 0;

 private:
  void connect();
  /// Unless another connection than that has been begun meanwhile.
  void connect_later(int number);
  void on_delivery(Delivery delivery);
  void on_message(const tmclmqtt::Message& message);
  void on_birth(const std::string& text);
  void on_answer(const tmclmqtt::Message& message);
  void learn(const std::string& epoch);

  Network& network_;
  boost::asio::any_io_executor executor_;
  std::string name_;
  std::string role_;
  tmcld::Wake came_;
  std::shared_ptr<Connection> connection_;
  int last_connection_ = 0;
  bool is_let_in_ = false;
  bool was_let_in_ = false;  ///< By the last connection.
  bool has_ended_ = false;
  std::deque<Publication> to_send_;  ///< Of QoS 1, when there is a connection again.
  std::map<std::uint64_t, Publication> unacknowledged_;
  std::uint64_t last_packet_ = 0;
  std::string epoch_;
  bool online_ = false;
  std::deque<Nonce> nonces_;
  std::map<std::string, json::object> unread_answers_;
  std::uint64_t last_correlation_ = 0;
};

}  // namespace tmcld::test

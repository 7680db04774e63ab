/// An MQTT 5 broker as far as gateways and users can tell: sessions, retained messages, wills,
/// message expiry and an access list. Does no I/O, reads no clock: the owner of its connections
/// says when something came.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "broker/message.hpp"
#include "tmcl/clock.hpp"

namespace tmclmqtt::test {

/// Whether a topic is of a subscription's filter.
bool is_of_filter(std::string_view filter, std::string_view topic);

/// In the words of mosquitto's acl_file, `pattern` and `user` with `topic`.
class AccessList {
 public:
  /// Throws std::invalid_argument of a line that it does not understand.
  explicit AccessList(const std::string& text);
  bool may_write(const std::string& user, std::string_view topic) const;
  bool may_read(const std::string& user, std::string_view topic) const;

 private:
  struct Rule {
    std::string user;  ///< Empty: of a pattern, for every user.
    std::string filter;
    bool reads = false;
    bool writes = false;
  };
  bool may(const std::string& user, std::string_view topic, bool Rule::*right) const;

  std::vector<Rule> rules_;
};

/// One connection, as the broker writes to it.
class Subscriber {
 public:
  virtual ~Subscriber() = default;
  virtual void on_message(Message message, int qos) = 0;
  /// The broker has closed the connection.
  virtual void on_close(std::string why) = 0;
};

struct ConnectPacket {
  std::string client_id;
  std::string user;
  bool clean_start = true;
  /// Zero: the session ends with the connection.
  std::chrono::seconds session_expiry{};
  std::optional<Publication> will{};
  tmcl::Duration will_delay{};
  std::size_t max_packet_bytes = max_packet_bytes_of_broker;

  static constexpr std::size_t max_packet_bytes_of_broker = 1'200'000;
};

enum class Reason : std::uint8_t {
  success = 0,
  no_matching_subscribers = 16,
  not_authorized = 135,
  topic_name_invalid = 144,
  packet_too_large = 149,
};

class SimBroker {
 public:
  /// What is kept for a session without a connection.
  static constexpr std::size_t most_queued = 100;

  explicit SimBroker(AccessList access) : access_(std::move(access)) {}

  /// Takes the session of the same client id over. Whether the session was there.
  bool connect(Subscriber& from, ConnectPacket packet, tmcl::TimePoint now);
  void subscribe(Subscriber& from, const std::string& filter, int qos, tmcl::TimePoint now);
  /// Closes the connection of a client that breaks the protocol.
  Reason publish(Subscriber& from, const Publication& publication, tmcl::TimePoint now);
  /// As asked: without its will.
  void disconnect(Subscriber& from, tmcl::TimePoint now);
  /// The connection has gone.
  void lose(Subscriber& from, tmcl::TimePoint now);

  std::optional<tmcl::TimePoint> next_due() const;
  /// Wills whose delay is over, and ends of sessions.
  void run_due(tmcl::TimePoint now);
  /// All connections are gone; `keeps`: sessions and retained messages are there again.
  void restart(bool keeps, tmcl::TimePoint now);

  /// Nothing if there is none, or its time is over.
  std::optional<Publication> retained(const std::string& topic, tmcl::TimePoint now) const;
  std::vector<std::string> retained_topics() const;
  /// As by a client that may everything.
  Reason publish_as_broker(const Publication& publication, tmcl::TimePoint now);

 private:
  struct Kept {
    Publication publication;
    tmcl::TimePoint since;
    std::string publisher;
  };
  struct Session {
    ConnectPacket packet;
    Subscriber* connection = nullptr;
    std::map<std::string, int> filters{};  ///< And the greatest QoS of each.
    std::deque<Kept> queue{};
    std::optional<tmcl::TimePoint> will_due{};
    std::optional<tmcl::TimePoint> ends{};
  };

  Session* session_of(const Subscriber& from);
  Reason pass_on(const Publication& publication, const std::string& publisher, tmcl::TimePoint now);
  void deliver(Session& session, const Kept& kept, int qos, bool retained, tmcl::TimePoint now);
  void publish_will(const std::string& client_id, tmcl::TimePoint now);
  void end_connection(Session& session, tmcl::TimePoint now);

  AccessList access_;
  std::map<std::string, Session> sessions_;  ///< By client id.
  std::map<std::string, Kept> retained_;
};

}  // namespace tmclmqtt::test

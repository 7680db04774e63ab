/// One connection to an MQTT 5 broker, until it is lost. The only files that know libmosquitto.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <tl/expected.hpp>

#include "broker/message.hpp"
#include "tmcl/clock.hpp"

namespace tmcld {
class Workers;
}

namespace tmclmqtt {

struct BrokerOptions {
  std::string host;
  std::uint16_t port = 0;
  std::string client_id;
  /// Paths of PEM files; without `ca` there is no TLS, unless the system's authorities vouch.
  std::string ca{};
  bool trusts_system = false;
  std::string certificate{};
  std::string key{};
  /// For a broker that asks for them; empty: the certificate says who it is.
  std::string user{};
  /// Called on a thread of `workers`, at each connection anew. Errors: why there is none.
  std::function<tl::expected<std::string, std::string>()> password{};
  std::optional<Publication> will{};
  std::uint32_t max_packet_bytes = tmclmqtt::max_packet_bytes;
  /// Within that a connection may come back without its will being published.
  std::uint32_t will_delay_s = 1;
  /// The broker publishes the will also when the connection ends as asked.
  bool will_at_end = false;
  /// After its TCP is there.
  tmcl::Duration time_to_be_let_in = std::chrono::seconds(5);
};

struct Subscribed {
  std::string filter;
  int qos = 0;
  bool own = false;  ///< Also what this connection publishes.
};

/// Its session is a clean one, and none is kept: what comes while it is not connected never comes.
class Broker {
 public:
  using OnMessage = std::function<void(Message message)>;
  enum class Sent : std::uint8_t { yes, too_long, no };

  virtual ~Broker() = default;
  virtual void subscribe(const Subscribed& to) = 0;
  virtual Sent publish(const Publication& publication) = 0;
  /// What was published has gone out: there is room for more.
  virtual bool has_room() const = 0;
  /// Until it is lost, or disconnect() was called: why.
  virtual boost::asio::awaitable<std::string> end() = 0;
  /// Ends it as asked: the broker does not publish the will.
  virtual void disconnect() = 0;
};

using Connected = tl::expected<std::shared_ptr<Broker>, std::string>;
/// Of connect_to_broker(), or of a broker in the same process. `on_room`: see Broker::has_room().
using ConnectToBroker = std::function<boost::asio::awaitable<Connected>(
    BrokerOptions options, Broker::OnMessage on_message, std::function<void()> on_room)>;

/// Returns when the broker has let it in. Name and TCP are waited for on a thread of `workers`.
/// Messages come from then on, in turns of the reactor of their own. Errors: why, in a sentence.
boost::asio::awaitable<Connected> connect_to_broker(tmcld::Workers& workers, BrokerOptions options,
                                                    Broker::OnMessage on_message,
                                                    std::function<void()> on_room);

}  // namespace tmclmqtt

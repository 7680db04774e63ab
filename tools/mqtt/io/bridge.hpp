/// The whole of tmcld-mqtt on one reactor: tmcld on one side, a broker on the other, each of which
/// may come and go.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "broker/broker.hpp"
#include "io/gateway_link.hpp"
#include "io/sparkplug_link.hpp"
#include "io/user_links.hpp"
#include "log/limiter.hpp"
#include "mqtt_config.hpp"
#include "protocol/axis_news.hpp"
#include "protocol/births.hpp"
#include "protocol/gate.hpp"
#include "protocol/home_assistant.hpp"
#include "protocol/listed_axis.hpp"
#include "protocol/outbox.hpp"

namespace tmclmqtt {

/// What a bridge is given by its program.
struct BridgeParts {
  ConnectToBroker connect;
  std::function<std::string()> draw;  ///< See Nonces.
  std::function<void()> on_turn;      ///< Called ten times a second while the reactor turns.
};

class Bridge : public std::enable_shared_from_this<Bridge> {
 public:
  Bridge(const boost::asio::any_io_executor& executor, MqttConfig config, BridgeParts parts);

  void start();
  /// Says farewell to the broker, and closes everything.
  void stop();
  /// A thread waits for a broker's name or its TCP, which cannot be called back.
  bool is_connecting() const { return connecting_ || (sparkplug_ && sparkplug_->is_connecting()); }

 private:
  static boost::asio::awaitable<void> serve_gateway(std::shared_ptr<Bridge> self);
  static boost::asio::awaitable<void> serve_broker(std::shared_ptr<Bridge> self);
  static boost::asio::awaitable<void> look(std::shared_ptr<Bridge> self);
  void start_sparkplug();

  /// Until the connection to tmcld is lost; why.
  boost::asio::awaitable<std::string> use_gateway();
  /// What there is to be asked for and to be told of. Errors: those of tmcld.
  boost::asio::awaitable<tmcl::client::Result<void>> get_to_know(GatewayLink& link);
  /// There may be others, or other ones may answer.
  static boost::asio::awaitable<void> list_axes(std::shared_ptr<Bridge> self);
  void know_axes(std::vector<ListedAxis> axes);
  void hear(std::string_view method, const boost::json::object& params);
  void hear_state(const boost::json::object& state);
  /// A connection to the broker, and what waits for it. Stops have one of their own: what fills
  /// the other one, with calls or with answers, keeps none out.
  struct Line {
    std::shared_ptr<Broker> broker{};  ///< Null while there is none.
    Outbox outbox{};
  };

  boost::asio::awaitable<std::string> use_broker();
  /// Errors: why there is none.
  boost::asio::awaitable<tl::expected<void, std::string>> connect(Line& line,
                                                                  std::string_view client,
                                                                  std::optional<Publication> will);
  void disconnect();
  void begin_on_broker();

  void take(Line& line, const Message& message);
  void carry_out(Line& line, Judged judged, tmcl::TimePoint now);
  /// Where a stop came from, and where its answer goes; without a topic it gets none.
  struct StopAsked {
    Line* line;
    std::optional<std::string> topic;
    std::string correlation;
    auto operator<=>(const StopAsked&) const = default;
  };
  /// Those that cannot be told apart by their answers get one: a sender that repeats its stop costs
  /// a gateway that is late no more than one that does not.
  using Stops = std::set<StopAsked>;

  void stop_axes(Line& line, const std::optional<ReplyTo>& reply);
  /// One for all that wait.
  void send_stops();
  /// tmcld may be there although it has cut this program off, and a stop cannot wait for that.
  void stop_by_another_link(Stops stops);
  static boost::asio::awaitable<void> stop_anew(std::shared_ptr<Bridge> self, Stops stops);
  void end_stops(const Stops& stops, const tmcl::client::Result<boost::json::object>& result);
  void answer(Line& line, const std::optional<ReplyTo>& reply,
              const tmcl::client::Result<boost::json::object>& result);
  /// `user`: whom a nonce is for; empty: none.
  std::string answer_text(const tmcl::client::Result<boost::json::object>& result,
                          const std::string& user);
  void say_birth();
  void replace_birth(Publication its_own);
  void add_news(std::vector<Publication> news);
  void add_due_news(tmcl::TimePoint now);
  void flush(Line& line);
  void log_often(std::string line);
  tmcl::TimePoint now() const { return clock_.now(); }

  boost::asio::any_io_executor executor_;
  tmcl::ContextClock clock_;
  MqttConfig config_;
  BridgeParts parts_;
  /// Drawn: a broker ends the connection of a client when another one comes with its id, whatever
  /// that one's certificate is.
  std::string client_id_;
  Gate gate_;
  Births births_;
  AxisNews news_;
  Line calls_;
  Line stops_;
  std::shared_ptr<UserLinks> users_;
  std::shared_ptr<GatewayLink> gateway_;  ///< Of its own; null while tmcld is not there.
  std::vector<ListedAxis> axes_;
  bool axes_are_old_ = false;  ///< Something has happened to them since they were listed.
  std::shared_ptr<SparkplugLink> sparkplug_;  ///< Null: not configured.
  std::optional<HomeAssistant> home_;         ///< None: not configured.
  tmcld::LogLimiter limiter_;
  std::string broker_problem_;  ///< The one logged last, since the connections were there last.
  int replaced_births_ = 0;     ///< Since the connection to the broker is there.
  Stops waiting_stops_;
  int stops_in_progress_ = 0;
  bool has_acted_since_stop_ = false;  ///< A user, by a call that went to tmcld.
  bool connecting_ = false;
  bool stopping_ = false;
};

}  // namespace tmclmqtt

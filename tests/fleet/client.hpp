/// A user of the whole fleet: waits for births, wants telemetry and counts it, moves all axes to
/// and fro, measures how long calls take, and stops everything. What it sees goes to standard
/// output, a JSON object a line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/json/object.hpp>

#include "async/workers.hpp"
#include "broker/broker.hpp"
#include "fleet/place.hpp"
#include "tmcl/context_clock.hpp"

namespace tmclfleet {

struct ClientOptions {
  std::size_t gateways = 0;
  std::size_t real = 0;         ///< So many of them, the first, are no plain clients.
  double calls_per_second = 0;  ///< Of reads, and as many of moves.
  std::int64_t measured_s = 0;
};

class FleetClient {
 public:
  FleetClient(boost::asio::io_context& context, tmcld::Workers& workers, FleetPlace place,
              const ClientOptions& options)
      : context_(context),
        workers_(workers),
        place_(std::move(place)),
        options_(options),
        clock_(context) {}

  /// Ends the context. Throws if it cannot get to the broker.
  boost::asio::awaitable<void> run();

 private:
  enum class Kind : std::uint8_t { read, nonce, move };
  struct Call {
    Kind kind = Kind::read;
    std::size_t gateway = 0;
    std::size_t move = 0;     ///< How many were begun before it.
    tmcl::TimePoint began{};  ///< When the first message of it went out.
    tmcl::TimePoint sent{};   ///< When the last one did.
  };
  struct Told {
    std::size_t ever = 0;
    std::size_t measured = 0;
  };
  struct Gateway {
    bool has_axes = false;
    bool is_away = false;
    std::set<std::string> stopped{};
  };

  boost::asio::awaitable<void> connect();
  boost::asio::awaitable<void> await_births();
  void want_telemetry();
  boost::asio::awaitable<void> make_calls(tmcl::Duration time);
  boost::asio::awaitable<void> await_answers();
  boost::asio::awaitable<void> stop_all();

  void take(const tmclmqtt::Message& message);
  void take_birth(std::string_view gateway, const tmclmqtt::Message& message);
  void take_answer(const tmclmqtt::Message& message);
  void take_stop(std::string_view gateway, const tmclmqtt::Message& message);

  void begin_read();
  void begin_move();
  void end_move_with(const Call& call, const boost::json::object& answer);
  void send(const Call& call, std::string_view method, std::string payload);
  void publish_stops();
  void publish_stop(std::string_view level);
  static bool is_stopped(const Gateway& gateway);
  bool all_are_stopped() const;
  void say_measured() const;

  boost::asio::io_context& context_;
  tmcld::Workers& workers_;
  FleetPlace place_;
  ClientOptions options_;
  tmcl::ContextClock clock_;
  std::shared_ptr<tmclmqtt::Broker> broker_;
  std::map<std::string, Gateway, std::less<>> gateways_;
  std::unordered_map<std::string, Told> telemetry_;  ///< By topic.
  tmcl::TimePoint wanted_{};
  std::unordered_map<std::uint64_t, Call> calls_;
  std::uint64_t last_call_ = 0;
  std::size_t reads_ = 0;
  std::size_t moves_ = 0;
  std::size_t late_ = 0;  ///< Refused because they took too long.
  std::size_t refused_ = 0;
  std::string refusal_;
  std::size_t stop_rounds_ = 0;
  bool is_measuring_ = false;
  std::vector<double> read_ms_;
  std::vector<double> nonce_ms_;
  std::vector<double> move_ms_;
  std::vector<double> nonce_and_move_ms_;
};

}  // namespace tmclfleet

/// Takes in clients on the unix socket.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "fronts/socket_file.hpp"
#include "fronts/unix_session.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

constexpr std::size_t max_clients = 1024;
/// Connections beside those of the clients, for stops and nothing else: a client that comes while
/// there are enough clients gets one.
constexpr std::size_t places_for_stops = 16;
/// How long the owner of such a place can ask before another client may get it.
constexpr tmcl::Duration time_to_ask = std::chrono::milliseconds(50);

/// At most `clients` clients, and places_for_stops.
class UnixServer : public std::enable_shared_from_this<UnixServer> {
 public:
  UnixServer(const boost::asio::any_io_executor& executor, SocketFile file,
             std::shared_ptr<Gateway> gateway, std::size_t clients = max_clients,
             std::shared_ptr<FrontShare> share = std::make_shared<FrontShare>());

  void start();
  /// Takes in no more clients and removes the socket.
  void stop_accepting();
  /// Lets every client have its answers, and then closes its connection.
  void finish_sessions();
  void close_sessions();
  /// The configuration says something else about who may do what: closes the connections of clients
  /// that may do less by it.
  void review_rights();
  std::size_t clients() const { return sessions_.size(); }
  bool has_calls_in_flight() const;
  /// That clients have not taken yet.
  bool has_output() const;

 private:
  using Protocol = boost::asio::local::stream_protocol;

  /// On a socket that another process opened, clients may have waited for long. A client that has
  /// asked for something already is cut off: its request may be stale.
  void take_in_who_waits();
  static boost::asio::awaitable<void> accept(std::shared_ptr<UnixServer> self);
  void take_in(Protocol::socket socket);
  bool is_full() const { return sessions_.size() - for_stops_.size() >= most_clients_; }
  /// Until there is a place for stops: the client that has had one for longest without asking for
  /// anything gives it up.
  boost::asio::awaitable<void> make_place_for_stop();

  Protocol::acceptor acceptor_;
  SocketFile file_;
  std::shared_ptr<Gateway> gateway_;
  std::size_t most_clients_;
  std::shared_ptr<FrontShare> share_;
  std::map<std::uint64_t, std::shared_ptr<UnixSession>> sessions_;
  struct PlaceForStops {
    std::uint64_t id;
    tmcl::TimePoint since;
  };
  std::deque<PlaceForStops> for_stops_;  ///< Of those, the oldest first.
  std::uint64_t last_id_ = 0;
};

}  // namespace tmcld

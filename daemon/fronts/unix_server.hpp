/// Takes in clients on the unix socket.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/local/stream_protocol.hpp>

#include "fronts/session.hpp"
#include "fronts/socket_file.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

constexpr std::size_t max_clients = 1024;

class UnixServer : public std::enable_shared_from_this<UnixServer> {
 public:
  UnixServer(const boost::asio::any_io_executor& executor, SocketFile file,
             std::shared_ptr<Gateway> gateway);

  void start();
  /// Takes in no more clients and removes the socket.
  void stop_accepting();
  /// Lets every client have its answers, and then closes its connection.
  void finish_sessions();
  void close_sessions();
  std::size_t clients() const { return sessions_.size(); }

 private:
  using Protocol = boost::asio::local::stream_protocol;

  static boost::asio::awaitable<void> accept(std::shared_ptr<UnixServer> self);
  void take_in(Protocol::socket socket);

  Protocol::acceptor acceptor_;
  SocketFile file_;
  std::shared_ptr<Gateway> gateway_;
  std::map<std::uint64_t, std::shared_ptr<Session>> sessions_;
  std::uint64_t last_id_ = 0;
};

}  // namespace tmcld

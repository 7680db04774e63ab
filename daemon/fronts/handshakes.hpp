/// TLS handshakes, for the server. A signature takes as long as hundreds of calls, and any program
/// that reaches the port can ask for one without being let in: they are computed on another thread,
/// one at a time, and the networks that clients come from have turns.
#pragma once

#include <string>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/system/error_code.hpp>

#include "async/workers.hpp"
#include "fronts/fair_turns.hpp"
#include "web/web_stream.hpp"

namespace tmcld {

class Handshakes {
 public:
  explicit Handshakes(const boost::asio::any_io_executor& executor) : turns_(executor) {}

  /// Of a stream that uses TLS. `received`: what has been read of it already. `network`: of the
  /// client. Reads nothing that comes behind the handshake. Errors: those of the connection, and
  /// of OpenSSL in the category of Asio.
  boost::asio::awaitable<boost::system::error_code> perform(WebStream& stream, std::string received,
                                                            std::string network);
  /// Waits for what is being computed. No more handshakes are made.
  void join();

 private:
  FairTurns turns_;
  Workers worker_{1};
  bool has_ended_ = false;
};

}  // namespace tmcld

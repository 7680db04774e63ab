/// The whole daemon: buses, axes and fronts around one reactor thread.
#pragma once

#include <exception>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <tl/expected.hpp>

#include "config/config.hpp"
#include "fronts/unix_server.hpp"
#include "gateway/gateway.hpp"

namespace tmcld {

class Daemon {
 public:
  /// Claims the socket. Errors: a sentence for a person, with what to try.
  static tl::expected<std::unique_ptr<Daemon>, std::string> create(
      const Config& config, const OpenLink& open_link = open_configured_link);

  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Waits for links that are being opened, and for paths that are being planned: what comes of
  /// them still needs the reactor.
  ~Daemon();

  /// Serves until stop() is called or, after end_on_signals(), SIGTERM or SIGINT comes. False if
  /// something was thrown that nobody could see to: then all axes were stopped.
  bool run();
  /// From any thread. Ends run() within a second: stops on their way are given a moment, whatever
  /// else is in progress is answered with how far it got. Axes on lines and paths are stopped
  /// before that, for which they may take some seconds, and firmware uploads come to their end, for
  /// which they may take some minutes.
  void stop();
  void end_on_signals();

  Gateway& gateway() { return *gateway_; }
  boost::asio::io_context& context() { return context_; }
  /// A thread hangs in the system, opening a link, and will not end soon.
  bool is_opening_links() const;

 private:
  Daemon() = default;
  static boost::asio::awaitable<void> begin_to_serve(Daemon& daemon);
  static boost::asio::awaitable<void> wait_for_signal(Daemon& daemon);
  static boost::asio::awaitable<void> end(Daemon& daemon);
  void end_after(const std::exception_ptr& failure) noexcept;

  boost::asio::io_context context_{1};
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<UnixServer> server_;
  bool ending_ = false;
};

}  // namespace tmcld

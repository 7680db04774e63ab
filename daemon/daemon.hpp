/// The whole daemon: buses, axes and fronts around one context, which one thread runs.
#pragma once

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <tl/expected.hpp>

#include "async/turns.hpp"
#include "config/config.hpp"
#include "config/load.hpp"
#include "fronts/http_server.hpp"
#include "fronts/port.hpp"
#include "fronts/unix_server.hpp"
#include "gateway/gateway.hpp"
#include "gateway/store/lock_file.hpp"
#include "log/audit_trail.hpp"
#include "service/service.hpp"

namespace tmcld {

class Daemon {
 public:
  /// The configuration as it is now, or would be with this text in the file that clients may set.
  /// May block.
  using LoadAgain = std::function<tl::expected<Config, tmcl::TextProblems>(
      const std::optional<std::string>& managed)>;

  /// Claims the socket, or takes that of the service, and opens the ports. The context must outlive
  /// it. Errors: a sentence for a person, with what to try.
  static tl::expected<std::unique_ptr<Daemon>, std::string> create(
      boost::asio::io_context& context, const Config& config,
      const OpenLink& open_link = open_configured_link, Service service = {},
      const std::optional<HttpConfig>& http = {});

  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;
  /// Waits for links that are being opened, and for paths that are being planned: what comes of
  /// them still needs the reactor.
  ~Daemon();

  /// Runs the context and serves until stop() is called or, after end_on_signals(), SIGTERM or
  /// SIGINT comes. False after an exception that no caller handled: then all axes were
  /// stopped.
  bool run();
  /// Serves as well, but another one runs the context, until has_ended().
  void start();
  /// To be told of everything that is thrown out of the context then. At the first one stops are on
  /// the wire when this returns, even where there is no memory, and the daemon begins to end.
  void on_failure(const std::exception_ptr& failure) noexcept;
  /// From any thread. Ends run() within a second: stops on their way are given a moment, whatever
  /// else is in progress is answered with how far it got. Axes that move are stopped before that,
  /// as the configuration says, for which they may take some seconds, and firmware uploads come
  /// to their end, for which they may take some minutes.
  void stop();
  /// SIGHUP has the audit file opened again, and the configuration taken over as it is then.
  void end_on_signals();
  /// Where its configuration can be loaded again. Without, clients cannot set it.
  void load_by(LoadAgain load) { load_ = std::move(load); }
  const LoadAgain& load() const { return load_; }
  const DaemonConfig& config() const { return config_; }
  /// To be held while a configuration is loaded and taken over, and the file of it replaced: one at
  /// a time. 0: no client.
  boost::asio::awaitable<Turns::Turn> take_turn_to_load(std::uint64_t client) {
    return turns_to_load_.take(client);
  }
  /// All of it, or nothing: see gateway/reload.hpp.
  static boost::asio::awaitable<tl::expected<std::string, std::vector<std::string>>> reload(
      Daemon& daemon, Config config);
  /// What would become of it; nothing changes. The configuration must outlive it.
  static boost::asio::awaitable<tl::expected<std::string, std::vector<std::string>>> foresee(
      Daemon& daemon, const Config& config);
  bool has_ended() const { return has_ended_; }
  /// Clients are let in.
  bool is_serving() const { return is_serving_; }
  bool is_ending() const { return ending_; }
  /// A client by the unix socket waits for an answer.
  bool has_calls_in_flight() const { return server_->has_calls_in_flight(); }
  /// A client by the unix socket has not taken yet what it is told.
  bool has_output() const { return server_->has_output(); }

  Gateway& gateway() { return *gateway_; }
  boost::asio::io_context& context() { return context_; }
  /// A thread hangs in the system, opening a link, and will not end soon.
  bool is_opening_links() const;

 private:
  Daemon(boost::asio::io_context& context, Service service, LockFile state_lock);
  static boost::asio::awaitable<void> begin_to_serve(Daemon& daemon);
  static boost::asio::awaitable<void> wait_for_signal(Daemon& daemon);
  static boost::asio::awaitable<void> load_again(Daemon& daemon);
  /// Nothing if it can be taken over without a restart, as far as the daemon is concerned.
  std::optional<std::string> objection_to(const Config& config) const;
  static boost::asio::awaitable<void> end(Daemon& daemon);
  /// Says that the reactor turns, for as long as it does: a bus that is lost or a module that is
  /// silent is no reason to be started again.
  static boost::asio::awaitable<void> report(Daemon& daemon);
  std::size_t clients() const;
  std::string status() const;
  void end_after(const std::exception_ptr& failure) noexcept;
  bool begin_to_end_after_failure() noexcept;

  boost::asio::io_context& context_;
  Service service_;
  /// Given back when an exception ends the daemon: where memory is missing, stops need some, too.
  std::unique_ptr<std::byte[]> reserve_;
  LockFile state_lock_;
  DaemonConfig config_;
  std::string other_sections_;
  LoadAgain load_;
  Turns turns_to_load_;
  bool is_loading_ = false;
  bool loads_once_more_ = false;  ///< It may have changed since it was read.
  std::shared_ptr<AuditTrail> audit_;
  std::shared_ptr<Gateway> gateway_;
  std::shared_ptr<UnixServer> server_;
  std::vector<std::shared_ptr<Port>> ports_;
  std::shared_ptr<HttpServer> http_;  ///< Null: there is none.
  bool has_failed_ = false;
  bool has_stopped_all_ = false;
  bool is_serving_ = false;
  bool ending_ = false;
  bool end_runs_ = false;
  bool has_ended_ = false;
};

}  // namespace tmcld

/// A configured bus: opened, lost and opened again, for as long as the daemon runs.
///
///     opening ──opened──▶ open ──link lost──▶ lost ──opened──▶ open
///        │ ▲                                   │ ▲
///        └─┘ failed: again after 100 ms..1 s   └─┘
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>

#include "async/wake.hpp"
#include "config/config.hpp"
#include "gateway/authority/gate.hpp"
#include "gateway/bus_link.hpp"
#include "gateway/event.hpp"
#include "gateway/module/module.hpp"
#include "gateway/store/journal.hpp"
#include "log/audit.hpp"
#include "log/limiter.hpp"
#include "log/sink.hpp"
#include "tmcl/bus.hpp"

namespace tmcld {

class DeadmanMemory;

/// What the gateway keeps beyond its own life, for all buses.
struct BusRecords {
  std::shared_ptr<Journal> journal{};        ///< Null without one.
  std::shared_ptr<DeadmanMemory> deadmen{};  ///< What is known of the deadmen of modules.
  AuditSink audit{};
};

class GatewayBus : public std::enable_shared_from_this<GatewayBus> {
 public:
  using State = BusLink::State;

  GatewayBus(const boost::asio::any_io_executor& executor, BusConfig config, OpenLink open_link,
             LogSink log, OnGatewayEvent on_event, std::shared_ptr<Arrivals> arrivals);

  /// Opens the link before start() does; blocks meanwhile.
  tmcl::Result<void> open_now();
  /// Begins to open the link, unless it is open, and to look after the modules; returns at once.
  void start();
  /// Ends everything in progress with Errc::link_lost and stays closed.
  void close();
  bool is_closed() const { return closed_; }
  /// A stop of each motor goes out at once, past all queues, and takes no memory; see
  /// tmcl::Bus::stop_at_once().
  void stop_at_once() const noexcept;
  /// What waits, and was admitted, moves nothing any more.
  void refuse_movements() const noexcept {
    if (line()) line()->refuse_movements();
  }
  /// The same, because the configuration has no such bus any more: those who use it are told.
  void retire();
  /// What clients that have gone only wanted to know keeps no others waiting.
  void end_reads_of_gone_clients() const noexcept;

  const std::string& name() const { return config_.name; }
  const BusConfig& config() const { return config_; }
  const boost::asio::any_io_executor& executor() const { return executor_; }
  const tmcl::ContextClock& clock() const { return clock_; }
  State state() const { return link_.state(); }
  /// Why the link is not open; empty while it is.
  const std::string& error() const { return link_.error(); }
  /// How many exchanges wait for their turn.
  std::size_t queued() const { return line() ? line()->queued() : 0; }
  BusLink& link() { return link_; }
  const BusLink& link() const { return link_; }
  bool is_can() const { return std::holds_alternative<tmcl::CanName>(config_.link); }

  /// The module of this address, if add_module() has made it: for axes, configured or not.
  GatewayModule* find_module(tmcl::ModuleAddress address) const;
  GatewayModule& add_module(tmcl::ModuleAddress address);
  /// Null where it is not known.
  const tmcl::Model* model_of(tmcl::ModuleAddress address) const;
  const std::map<tmcl::ModuleAddress, std::unique_ptr<GatewayModule>>& modules() const {
    return modules_;
  }

  /// To be told before start().
  void keep(BusRecords records) { records_ = std::move(records); }
  /// What has to be put in order if the process ends; null without a journal.
  const std::shared_ptr<Journal>& journal() const { return records_.journal; }
  /// Null before keep().
  const std::shared_ptr<DeadmanMemory>& deadmen() const { return records_.deadmen; }
  /// For lines about what the gateway itself sets.
  void audit(std::string line) const;
  /// A module may need a command at another time than before.
  void look_at_feeding() { feeding_.notify(); }
  /// What decides what it lets out.
  Gate& gate() { return gate_; }
  Motors& motors() { return gate_.motors(); }
  const Motors& motors() const { return gate_.motors(); }
  /// One exchange, exactly as given.
  boost::asio::awaitable<tmcl::Result<tmcl::Answer>> execute(tmcl::Request request,
                                                             RunOptions options);
  /// Runs a verb to its end, or until there is an objection. What moves a motor or sets something
  /// is judged before it is queued, and again when its bytes go out: see judge.hpp. So are limits,
  /// the premise and the objection. For the verb it is as if the module had refused it. A verb that
  /// ends like this has Outcome::unknown if something of it went out before that was no mere
  /// question.
  /// Errors: besides those of the verb and of may_send(), Errc::link_lost while the link is not
  /// open.
  template <class T>
  boost::asio::awaitable<T> run(tmcl::Script<T> script, RunOptions options) {
    auto ended = co_await gate_.run(script, std::move(options));
    if (ended.objection) {
      ended.withdraw_turning(*ended.objection);
      co_return tl::unexpected(std::move(*ended.objection));
    }
    auto result = script.take();
    if (!result && ended.broke_off) result.error().outcome = tmcl::Outcome::unknown;
    if (!result) ended.withdraw_turning(result.error());
    co_return result;
  }

  /// Axes of this bus are on paths. What can wait, waits then: see the poller.
  bool has_paths() const { return motors().claimed_by(ClaimKind::path) > 0; }

  // For the parts of this bus.
  /// Null while the link is not open.
  const std::shared_ptr<tmcl::Bus>& line() const { return link_.bus(); }
  tmcl::Error not_open() const;
  /// Tells everyone.
  void emit(GatewayEvent event);
  /// Not more often than a LogLimiter allows.
  void log(LogLevel level, const std::string& line);

 private:
  boost::asio::awaitable<void> rest(tmcl::Duration duration);

  static boost::asio::awaitable<void> serve(std::shared_ptr<GatewayBus> self);
  boost::asio::awaitable<bool> open();
  boost::asio::awaitable<void> look_after_modules();
  static boost::asio::awaitable<void> feed_modules(std::shared_ptr<GatewayBus> self);
  void attach(tmcl::Link link);
  void detach();
  void on_bus_event(const tmcl::BusEvent& event);

  boost::asio::any_io_executor executor_;
  BusConfig config_;
  LogSink log_;
  OnGatewayEvent on_event_;
  tmcl::ContextClock clock_;
  Wake changed_;
  bool closed_ = false;
  bool retired_ = false;
  BusLink link_;
  std::map<tmcl::ModuleAddress, std::unique_ptr<GatewayModule>> modules_;
  Wake feeding_;
  BusRecords records_;
  Gate gate_;
  LogLimiter log_limiter_;
};

}  // namespace tmcld

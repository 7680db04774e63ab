/// A tmcld in the process of the modules, all of it in virtual time.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <tl/expected.hpp>

#include "daemon/daemon.hpp"
#include "options.hpp"
#include "sim/ports/port.hpp"
#include "sim/ports/scheduler.hpp"
#include "tmcl/virtual_time.hpp"

namespace tmclsim {

/// The configuration in a file of tmcld's. Errors: lines for a person.
tl::expected<tmcld::Config, std::vector<std::string>> load_gateway_config(const std::string& path);

/// Each bus of the configuration reaches all modules.
///
/// Time stands still while no client waits for an answer. While one does it goes from one timer to
/// the next, and a client may ask for more of it by the console. So a wait for a movement lasts as
/// long as what is computed for it, and comes to the same every time. No lease runs out while a
/// call waits: how would its holder renew it? Only time that is asked for takes it away.
class OwnGateway {
 public:
  /// `time` is that of `io`; they, and the modules of the scheduler, must outlive it. Serves when
  /// this returns, and its modules are known. Errors: a sentence for a person.
  static tl::expected<std::unique_ptr<OwnGateway>, std::string> create(
      boost::asio::io_context& io, tmcl::VirtualTime& time, tmcl::sim::Scheduler& modules,
      const tmcld::Config& config, const Wires& wires);
  OwnGateway(const OwnGateway&) = delete;
  OwnGateway& operator=(const OwnGateway&) = delete;
  ~OwnGateway();

  /// Until SIGTERM or SIGINT.
  void run();
  /// One timer's worth of time, or what comes from outside, which may have to be waited for.
  void turn();
  /// Something waits for time to pass.
  bool goes_on() const;
  /// To a line of the console: see the manual. Nothing: it comes later, on standard output.
  std::string answer(std::string_view line);

  tmcld::Daemon& daemon() { return *daemon_; }
  /// Since it serves.
  tmcl::Duration elapsed() const { return time_->now() - began_; }

 private:
  OwnGateway(boost::asio::io_context& io, tmcl::VirtualTime& time, tmcl::sim::Scheduler& modules,
             const Wires& wires);
  tmcl::Result<tmcl::Link> open(const tmcld::BusConfig& bus);
  void become_ready();
  bool go_on();
  bool waits_for_reader();
  std::string run_for(std::string_view text);

  boost::asio::io_context* io_;
  tmcl::VirtualTime* time_;
  tmcl::sim::Scheduler* modules_;
  Wires wires_;
  std::map<std::string, std::unique_ptr<tmcl::sim::Port>> lines_;  ///< By the name of the bus.
  std::unique_ptr<tmcld::Daemon> daemon_;
  tmcl::TimePoint began_{};
  /// Until then it goes on, whether a client waits or not.
  std::optional<tmcl::TimePoint> asked_until_;
  bool has_slow_reader_ = false;
};

}  // namespace tmclsim

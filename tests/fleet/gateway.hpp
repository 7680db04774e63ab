/// A gateway as it is delivered, but for its process: tmcld and tmcld-mqtt on one reactor, with a
/// simulated module behind a line in memory.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "async/workers.hpp"
#include "daemon.hpp"
#include "fleet/place.hpp"
#include "io/bridge.hpp"
#include "sim/bench.hpp"
#include "sim/ports/scheduler.hpp"
#include "sim/wire/serial_line.hpp"
#include "tmcl/link.hpp"

namespace tmclfleet {

/// One TMCM-6110 that answers at once, as on USB.
class SimulatedLine {
 public:
  using OnStop = std::function<void()>;

  explicit SimulatedLine(boost::asio::io_context& context);

  /// The gateway's end, once; from any thread.
  tmcl::Result<tmcl::Link> open();
  /// Told of each stop of a motor that comes by the line.
  OnStop on_stop;
  bool stands();

 private:
  void wait();
  bool read();
  void note(std::span<const std::uint8_t> bytes) const;

  tmcl::ContextClock clock_;
  tmcl::sim::Bench bench_;
  tmcl::sim::Scheduler scheduler_;
  tmcl::sim::SerialLine serial_;
  std::optional<tmcl::Link> near_;
  std::optional<tmcl::Link> far_;
  boost::asio::posix::stream_descriptor readiness_;
};

class SimulatedGateway {
 public:
  /// Throws if its tmcld cannot begin.
  SimulatedGateway(boost::asio::io_context& context, tmcld::Workers& workers,
                   const FleetPlace& place, int number);

  void start();
  /// When all of its motors stood after they had been stopped; nothing: they were not, or one still
  /// turns.
  const std::optional<tmcl::TimePoint>& stood() const { return stood_; }

 private:
  static boost::asio::awaitable<void> watch_until_it_stands(SimulatedGateway& gateway);

  boost::asio::io_context& context_;
  SimulatedLine line_;
  std::unique_ptr<tmcld::Daemon> daemon_;
  std::shared_ptr<tmclmqtt::Bridge> bridge_;
  bool is_watched_ = false;
  std::optional<tmcl::TimePoint> stood_;
};

}  // namespace tmclfleet

/// Gives a bench the processor when something is due, and lets it sleep otherwise.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "sim/bench.hpp"

namespace tmcl::sim {

/// The bench must run on a RealClock.
class Scheduler {
 public:
  Scheduler(boost::asio::io_context& io, Bench& bench) : bench_(&bench), timer_(io) {}

  Bench& bench() const { return *bench_; }
  /// Does what is due now and sets the timer for what comes next. To be called after every input.
  void touch();

 private:
  void sleep_until(TimePoint due);

  Bench* bench_;
  boost::asio::steady_timer timer_;
  TimePoint armed_ = never;
};

}  // namespace tmcl::sim

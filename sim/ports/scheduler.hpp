/// Gives a bench the processor when something is due, and lets it sleep otherwise.
#pragma once

#include <boost/asio/io_context.hpp>

#include "sim/bench.hpp"
#include "tmcl/timer.hpp"

namespace tmcl::sim {

/// The bench must run on the ContextClock of the same context.
class Scheduler {
 public:
  Scheduler(boost::asio::io_context& io, Bench& bench)
      : bench_(&bench), timer_(io.get_executor()) {}

  Bench& bench() const { return *bench_; }
  /// Does what is due now and sets the timer for what comes next. To be called after every input.
  void touch();

 private:
  void sleep_until(TimePoint due);

  Bench* bench_;
  Timer timer_;
  TimePoint armed_ = never;
};

}  // namespace tmcl::sim

/// A wire with all modules of a bench on it.
#pragma once

#include "sim/module/event_sink.hpp"
#include "tmcl/clock.hpp"

namespace tmcl::sim {

class Bench;

class Line : public EventSink {
 public:
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() override;

  /// When run_due() has something to send; `never` if nothing waits.
  virtual TimePoint next_due() const = 0;
  virtual void run_due() = 0;

 protected:
  /// The bench must outlive the line.
  explicit Line(Bench& bench);
  Bench& bench() const { return *bench_; }

 private:
  Bench* bench_;
};

}  // namespace tmcl::sim

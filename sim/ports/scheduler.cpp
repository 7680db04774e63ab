#include "sim/ports/scheduler.hpp"

namespace tmcl::sim {

void Scheduler::touch() {
  bench_->run_due();
  const auto due = bench_->next_due();
  if (due != armed_) sleep_until(due);
}

void Scheduler::sleep_until(TimePoint due) {
  armed_ = due;
  timer_.cancel();
  if (due == never) return;
  timer_.expires_at(due);
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (error) return;
    armed_ = never;
    touch();
  });
}

}  // namespace tmcl::sim

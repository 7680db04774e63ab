/// Real time is for the reactor, which a service may be given (CPUSchedulingPolicy= of systemd) and
/// every thread it starts inherits. What takes long must not keep it from the processor.
#pragma once

#include <sched.h>

namespace tmcld {

/// For the thread that calls it. Without a scheduling policy of real time nothing changes.
inline void take_ordinary_priority() {
  const int policy = ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  if (policy != SCHED_RR && policy != SCHED_FIFO) return;
  // It may always give up what it has.
  const sched_param none{};
  ::sched_setscheduler(0, SCHED_OTHER, &none);
}

}  // namespace tmcld

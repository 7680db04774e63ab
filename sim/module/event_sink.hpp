/// Where a module says what it was not asked for in that moment.
#pragma once

#include <cstdint>

namespace tmcl::sim {

class Module;

class EventSink {
 public:
  virtual ~EventSink() = default;
  /// The motors of this bit mask have reached their targets (command 138).
  virtual void target_reached(const Module& module, std::int32_t motors) = 0;
};

}  // namespace tmcl::sim

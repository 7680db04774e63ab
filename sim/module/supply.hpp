/// What the motors of a module are fed with, and how it breaks down.
#pragma once

#include "sim/module/module_state.hpp"

namespace tmcl::sim {

class Supply {
 public:
  explicit Supply(ModuleState& module) : module_(module) {}

  /// In tenths of a volt; ends a brown-out.
  void set(std::int32_t supply);
  /// Too little of it for so long.
  void brown_out(Duration duration);
  TimePoint next_due() const { return returns_; }
  void run_due();

 private:
  void put(std::int32_t supply);

  ModuleState& module_;
  TimePoint returns_ = never;
  std::int32_t before_ = 0;  // the brown-out
};

}  // namespace tmcl::sim

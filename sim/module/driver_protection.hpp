/// How a motor driver protects itself: it switches off, and tells why.
#pragma once

#include "sim/stage/driver_fault.hpp"

namespace tmcl::sim {

/// A short circuit to ground switches the driver off until it is disabled and enabled again (TOFF =
/// 0); heat does, until its prewarning is over as well. An open coil is only told. So the data
/// sheets of the TMC2660 and the TMC5160.
class DriverProtection {
 public:
  /// What is wrong now; `against_shorts`: that protection is on (DISS2G = 0).
  void look(const DriverFaults& faults, bool against_shorts);
  /// The firmware has disabled the driver, or it has lost its supply.
  void reset();

  bool is_off() const;
  /// As in parameter 208.
  std::int32_t flags() const { return told_.bits(); }

 private:
  DriverFaults told_;
};

}  // namespace tmcl::sim

#include "sim/module/driver_protection.hpp"

#include <initializer_list>

namespace tmcl::sim {

void DriverProtection::look(const DriverFaults& faults, bool against_shorts) {
  using enum DriverFault;
  const bool is_hot = faults.has(overtemperature);
  const bool is_warm = is_hot || faults.has(overtemperature_warning);
  told_.set(overtemperature, is_hot || (is_warm && told_.has(overtemperature)));
  told_.set(overtemperature_warning, is_warm);
  for (const auto coil : {open_load_a, open_load_b}) told_.set(coil, faults.has(coil));
  if (!against_shorts) return;
  for (const auto coil : {short_a, short_b}) {
    if (faults.has(coil)) told_.set(coil, true);
  }
}

void DriverProtection::reset() { told_ = {}; }

bool DriverProtection::is_off() const {
  using enum DriverFault;
  return told_.has(overtemperature) || told_.has(short_a) || told_.has(short_b);
}

}  // namespace tmcl::sim

#include "sim/module/supply.hpp"

#include <algorithm>

namespace tmcl::sim {
namespace {

// In tenths of a volt: too little for the drivers. Our choice.
constexpr std::int32_t brown_out_supply = 60;

}  // namespace

void Supply::set(std::int32_t supply) {
  returns_ = never;
  put(supply);
}

void Supply::brown_out(Duration duration) {
  if (returns_ == never) before_ = module_.io.supply();
  returns_ = module_.now + duration;
  put(std::min(brown_out_supply, before_));
}

void Supply::run_due() {
  if (module_.now < returns_) return;
  returns_ = never;
  put(before_);
}

void Supply::put(std::int32_t supply) {
  module_.io.set_analog(Io::supply_voltage_port, supply);
  for (auto& axis : module_.axes) axis.set_supply(supply);
}

}  // namespace tmcl::sim

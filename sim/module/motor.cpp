#include "sim/module/motor.hpp"

#include "sim/module/sixpoint_motor.hpp"
#include "sim/module/tmc429_motor.hpp"
#include "sim/module/tmc457_motor.hpp"

namespace tmcl::sim {

std::unique_ptr<Motor> make_motor(Family family, TimePoint power_on) {
  switch (family) {
    case Family::tmc429: return std::make_unique<Tmc429Motor>(power_on);
    case Family::tmc457: return std::make_unique<Tmc457Motor>(power_on);
    case Family::sixpoint:
    case Family::tmc4361: return std::make_unique<SixPointMotor>(family, power_on);
  }
  return nullptr;
}

}  // namespace tmcl::sim

#include "sim/module/motor.hpp"

#include "sim/module/sixpoint_motor.hpp"
#include "sim/module/stand_in_motor.hpp"
#include "sim/module/tmc429_motor.hpp"
#include "sim/module/tmc4361_motor.hpp"
#include "sim/module/tmc457_motor.hpp"

namespace tmcl::sim {

std::unique_ptr<Motor> make_motor(const Model& model, TimePoint power_on,
                                  const ModuleTraits& traits) {
  switch (model.family) {
    case Family::tmc429: return std::make_unique<Tmc429Motor>(power_on, traits);
    case Family::tmc457: return std::make_unique<Tmc457Motor>(power_on);
    case Family::sixpoint: return std::make_unique<SixPointMotor>(power_on);
    case Family::tmc4361: return std::make_unique<Tmc4361Motor>(model, power_on);
    case Family::firmware: return std::make_unique<StandInMotor>(model, power_on);
  }
  return nullptr;
}

}  // namespace tmcl::sim

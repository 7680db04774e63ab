/// What a stand-alone program sees of the module on which it runs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/module/answer.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"

namespace tmcl::sim {

/// What can be waited for, or can interrupt a program.
struct MotorConditions {
  bool at_target = false;
  bool searching = false;  ///< A reference search is going on.
  bool home_switch = false;
  bool left_switch = false;
  bool right_switch = false;
  bool stalled = false;   ///< stallGuard has stopped the motor.
  bool deviated = false;  ///< The encoder was too far away from the position.
};

/// What raises the error flags EAL, EDV, EPO and ESD as long as it lasts. (ETO is raised by a
/// WAIT.)
struct Alarms {
  bool external = false;
  bool deviation = false;  ///< Of any motor.
  bool position = false;
  bool shutdown = false;
};

/// Everything is as it is now: the module brings itself up to date before it lets a program run.
class ProgramHost {
 public:
  virtual ~ProgramHost() = default;

  /// Executes a command that a host could send as well, and answers it as it would the host.
  virtual Answer perform(const Request& request) = 0;

  /// Global parameters of bank 2; every number is a variable.
  virtual std::int32_t user_variable(std::uint8_t number) const = 0;
  virtual void set_user_variable(std::uint8_t number, std::int32_t value) = 0;
  /// Global parameters of bank 3: a timer's period in ms, or on which edge of a switch or input an
  /// interrupt comes (0 none, 1 rising, 2 falling, 3 both). 0 for a number that is none.
  virtual std::int32_t interrupt_setting(std::uint8_t number) const = 0;
  /// Global parameter 81.
  virtual std::int32_t code_protection() const = 0;

  virtual std::size_t motors() const = 0;
  virtual MotorConditions motor(std::size_t number) const = 0;
  /// Digital inputs; those from interrupt 39 on.
  virtual std::size_t inputs() const = 0;
  virtual bool input(std::size_t number) const = 0;
  virtual Alarms alarms() const = 0;

  /// When something of the above may next change by itself, such as at a motor's arrival; `never`
  /// if that cannot be foreseen. Each action from outside is followed by run_due().
  virtual TimePoint next_event() const = 0;
};

}  // namespace tmcl::sim

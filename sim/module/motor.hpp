/// What the firmware of every family of modules can do with a motor.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sim/module/due.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/module_traits.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// What becomes of a motor if nothing is written.
struct MotionForecast {
  /// When it stands on its target; `never` if that cannot be foreseen.
  TimePoint arrival = never;
  /// When it stands for good, on its target or not; `never` the same.
  TimePoint rest = never;
  /// When to look again, at a motor that goes to and fro without end: so that no later
  /// look has to work out hours of that. `never` for all others.
  TimePoint look_again = never;
};

/// What a module makes of its inputs for stop switches.
struct SwitchWiring {
  bool left_inverted = false;
  bool right_inverted = false;
  bool swapped = false;
};

class Motor {
 public:
  virtual ~Motor() = default;

  /// Lets time pass. An earlier time than the present one changes nothing.
  virtual void advance_to(TimePoint time) = 0;
  virtual MotionForecast outlook() const = 0;

  /// -1, 0 or 1: where it turns in this instant.
  virtual int heading() const = 0;
  /// Its speed is just growing.
  virtual bool accelerates() const = 0;
  /// The position counter, which wraps at so many bits.
  virtual std::int32_t position() const = 0;
  virtual int position_bits() const = 0;
  /// In microsteps per second.
  virtual std::int64_t speed() const = 0;
  /// When to look whether it has gone more than so many microsteps back or ahead from here: exactly
  /// when it has, or earlier if that is too far to be foreseen; `never` if it never will.
  virtual TimePoint passing(std::int64_t back, std::int64_t ahead) const = 0;
  /// When its acceleration may change otherwise than evenly; `never` if it will not. Not const: the
  /// generator works out the movement once.
  virtual TimePoint next_change() = 0;
  /// As passing(), of whether it has come to stand or turned round.
  virtual TimePoint turning() const = 0;

  virtual SwitchWiring wiring() const { return {}; }
  /// Which stop switches are active as the chip sees them: the left one bars negative motion.
  virtual void set_switches(bool left, bool right) = 0;
  /// Stops dead, and stands until the next command.
  virtual void halt() = 0;
  /// Calls the present position so; a motor that stands goes on standing.
  virtual void set_position(std::int32_t position) = 0;

  /// Nothing if the motor has no part in the parameter.
  virtual std::optional<std::int32_t> read(const ParameterInfo& row) const = 0;
  /// Takes note of a parameter within its range, where the unit mode does not change that range.
  /// Errors: invalid_value, and nothing has changed, for what the chip does not take. Settings that
  /// do not go together are no error: the chip takes them.
  virtual Status write(const ParameterInfo& row, std::int32_t value) = 0;

  /// A register of the motion controller by its address in the chip. What the ramp generator does
  /// not have keeps the word that was written, and begins with 0. Reading may clear events.
  virtual std::int32_t read_chip(std::uint8_t address) = 0;
  /// Bits that a register does not have are lost, and what only the chip writes stays as it is.
  /// Errors: invalid_value, and nothing has changed, for what the generator does not take. The
  /// firmware knows nothing of it: with the next command it writes what the parameters say.
  virtual Status write_chip(std::uint8_t address, std::int32_t value) = 0;

  /// ROR, or ROL with the other sign. Errors: invalid_value for more than the chip can do.
  virtual Status rotate(std::int64_t velocity) = 0;
  /// MST: a ramp to standstill.
  virtual void stop() = 0;
  /// MVP; positions wrap as the chip's do.
  virtual void move_to(std::int64_t position) = 0;
  /// How fast a positioning goes at most: parameter 4, in the chip's unit.
  virtual std::int64_t top_speed() const = 0;
  /// So fast instead, until the next positioning or until parameter 4 is written; that parameter
  /// stays what it is.
  virtual void limit_positioning(std::int64_t speed) = 0;
  /// What MVP REL counts from.
  virtual std::int32_t relative_origin() const = 0;
};

/// The way from one reading of a position counter to another, as long as it is less than half of
/// what the counter holds.
inline std::int64_t way_between(std::int32_t from, std::int32_t to, int position_bits) {
  const int spare = 64 - position_bits;
  const auto raw = static_cast<std::uint64_t>(std::int64_t{to} - from);
  return static_cast<std::int64_t>(raw << spare) >> spare;
}

std::unique_ptr<Motor> make_motor(const Model& model, TimePoint power_on,
                                  const ModuleTraits& traits);

}  // namespace tmcl::sim

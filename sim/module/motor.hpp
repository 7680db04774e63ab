/// What the firmware of every family of modules can do with a motor.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "sim/module/due.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// What becomes of a motor if nothing is written.
struct Outlook {
  /// When it stands on its target; `never` if that cannot be foreseen.
  TimePoint arrival = never;
  /// When to look again, at a motor that goes to and fro without end: so nobody has to wait one day
  /// until hours of that are worked out. `never` for all others.
  TimePoint look_again = never;
};

class Motor {
 public:
  virtual ~Motor() = default;

  /// Lets time pass. An earlier time than the present one changes nothing.
  virtual void advance_to(TimePoint time) = 0;
  virtual Outlook outlook() const = 0;

  /// Nothing if the motor has no part in the parameter.
  virtual std::optional<std::int32_t> read(const ParameterInfo& row) const = 0;
  /// Takes note of a parameter within its range, where the unit mode does not change that range.
  /// Errors: invalid_value, and nothing has changed, for what the chip does not take. Settings that
  /// do not go together are no error: the chip takes them.
  virtual Status write(const ParameterInfo& row, std::int32_t value) = 0;

  /// ROR, or ROL with the other sign. Errors: invalid_value for more than the chip can do.
  virtual Status rotate(std::int64_t velocity) = 0;
  /// MST: a ramp to standstill.
  virtual void stop() = 0;
  /// MVP; positions wrap as the chip's do.
  virtual void move_to(std::int64_t position) = 0;
  /// What MVP REL counts from.
  virtual std::int32_t relative_origin() const = 0;
};

std::unique_ptr<Motor> make_motor(Family family, TimePoint power_on);

}  // namespace tmcl::sim

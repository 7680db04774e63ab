/// The global parameters of one module (bank 0).
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include <tl/expected.hpp>

#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

class Globals {
 public:
  /// The address is the one on serial lines and on CAN alike. `clock` drives the tick timer (132).
  Globals(ModuleAddress address, const Clock& clock);

  /// What GGP answers: wrong_type for a number that is not in the table.
  tl::expected<std::int32_t, Status> get(std::uint8_t number) const;
  /// What SGP answers: wrong_type for a number that cannot be written, invalid_value out of range.
  /// There is no EEPROM to lose: a new value acts at once and lasts as long as the module.
  Status set(std::uint8_t number, std::int32_t value);

  /// For the module's own use; the number must be in the table.
  std::int32_t value(std::uint8_t number) const { return values_[number]; }
  std::uint8_t byte(std::uint8_t number) const {
    return static_cast<std::uint8_t>(values_[number] & 0xFF);
  }
  std::chrono::milliseconds milliseconds(std::uint8_t number) const {
    return std::chrono::milliseconds(values_[number]);
  }

 private:
  std::int32_t tick_timer() const;

  const Clock* clock_;
  TimePoint timer_zero_;
  std::array<std::int32_t, 256> values_{};
};

}  // namespace tmcl::sim

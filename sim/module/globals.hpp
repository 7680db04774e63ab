/// The global parameters of one module, in all banks.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <random>

#include <tl/expected.hpp>

#include "sim/module/eeprom.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

/// Bank 0 are the parameters of the module, bank 2 the user variables of stand-alone programs, and
/// bank 3 says what their interrupts listen to. Bank 1 is for special firmware, and empty.
///
/// What the table calls stored is written to the EEPROM by SGP itself in bank 0, and by STGP in the
/// others. All of it acts at once, addresses included: manuals do not agree on whether these wait
/// for the next start, and the reply still carries the old ones.
class Globals {
 public:
  static constexpr std::uint8_t parameter_bank = global_bank::parameters;
  static constexpr std::uint8_t variable_bank = global_bank::user_variables;
  static constexpr std::uint8_t interrupt_bank = global_bank::interrupts;

  /// As they are after a start at this time. The model and the EEPROM must outlive them.
  Globals(const Model& model, Eeprom& eeprom, TimePoint start);

  /// What GGP answers: wrong_type for an unknown number, invalid_value for an unknown bank. Reading
  /// the random number (133) makes a new one.
  tl::expected<std::int32_t, Status> get(std::uint8_t bank, std::uint8_t number, TimePoint now);
  /// What SGP answers: wrong_type for a number that cannot be written, invalid_value for an unknown
  /// bank or out of range, eeprom_locked.
  Status set(std::uint8_t bank, std::uint8_t number, std::int32_t value, TimePoint now);
  /// What STGP answers: wrong_type for what cannot be kept, invalid_value for an unknown bank,
  /// eeprom_locked.
  Status store(std::uint8_t bank, std::uint8_t number);
  /// What RSGP answers. What was never stored gets its factory setting.
  Status restore(std::uint8_t bank, std::uint8_t number);

  /// Whether parameter 73 forbids to write anything to the EEPROM.
  bool eeprom_locked() const;

  /// Of bank 0, for the module's own use; 0 for what it does not have.
  std::int32_t value(std::uint8_t number) const { return values_[number]; }
  std::uint8_t byte(std::uint8_t number) const {
    return static_cast<std::uint8_t>(values_[number] & 0xFF);
  }
  /// Whose number differs between models; 0 if none is set.
  std::uint8_t serial_secondary_address() const { return byte(secondary_address_number_); }
  std::chrono::milliseconds milliseconds(std::uint8_t number) const {
    return std::chrono::milliseconds(values_[number]);
  }

  std::int32_t user_variable(std::uint8_t number) const { return variables_[number]; }
  void set_user_variable(std::uint8_t number, std::int32_t value) { variables_[number] = value; }
  /// Of bank 3; 0 for what it does not have.
  std::int32_t interrupt_setting(std::uint8_t number) const { return interrupts_[number]; }

 private:
  using Values = std::array<std::int32_t, 256>;
  tl::expected<GlobalRange, Status> find(std::uint8_t bank, std::uint8_t number) const;
  Values& values_of(std::uint8_t bank);

  void load_addresses();
  void load(std::uint8_t bank, std::uint8_t number, bool stored, std::int32_t initial);
  void keep(std::uint8_t bank, std::uint8_t number);
  Status lock(std::int32_t code);

  std::int32_t tick_timer(TimePoint now) const;
  std::int32_t next_random_number();

  const Model* model_;
  Eeprom* eeprom_;
  TimePoint timer_zero_;
  std::minstd_rand random_;
  std::uint8_t secondary_address_number_;
  Values values_{};
  Values variables_{};
  Values interrupts_{};
};

}  // namespace tmcl::sim

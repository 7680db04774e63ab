/// Positions that a module remembers for each motor, for MVP COORD.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/module/eeprom.hpp"
#include "tmcl/model.hpp"

namespace tmcl::sim {

/// Numbers are 0..20, motors those of the model. A coordinate that was never set is 0: the manuals
/// only say that it must be set first. Number 0 is never in the EEPROM.
class Coordinates {
 public:
  /// The EEPROM must outlive them.
  Coordinates(const Model& model, Eeprom& eeprom) : eeprom_(&eeprom), values_(model.axes) {}

  std::int32_t get(std::size_t motor, std::uint8_t number) const { return values_[motor][number]; }
  void set(std::size_t motor, std::uint8_t number, std::int32_t value) {
    values_[motor][number] = value;
  }

  /// Into the EEPROM.
  void keep(std::size_t motor, std::uint8_t number);
  /// The same number of all motors; number 0 stands for all the others.
  void keep_all(std::uint8_t number);
  /// The other way; what was never kept becomes 0.
  void load_all(std::uint8_t number);

 private:
  void load(std::size_t motor, std::uint8_t number);

  Eeprom* eeprom_;
  std::vector<std::array<std::int32_t, coordinates_per_motor>> values_;
};

}  // namespace tmcl::sim

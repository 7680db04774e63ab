#include "sim/module/coordinates.hpp"

namespace tmcl::sim {
namespace {

struct Range {
  std::uint8_t first;
  std::uint8_t last;
};

Range numbers_meant(std::uint8_t number) {
  if (number != 0) return {number, number};
  return {1, coordinates_per_motor - 1};
}

EepromCell cell(std::size_t motor, std::uint8_t number) {
  return {EepromCell::Area::coordinate, static_cast<std::uint8_t>(motor), number};
}

}  // namespace

void Coordinates::keep(std::size_t motor, std::uint8_t number) {
  if (number != 0) eeprom_->write(cell(motor, number), get(motor, number));
}

void Coordinates::load(std::size_t motor, std::uint8_t number) {
  set(motor, number, eeprom_->read(cell(motor, number)).value_or(0));
}

void Coordinates::keep_all(std::uint8_t number) {
  const auto [first, last] = numbers_meant(number);
  for (std::size_t motor = 0; motor < values_.size(); ++motor) {
    for (auto n = first; n <= last; ++n) keep(motor, n);
  }
}

void Coordinates::load_all(std::uint8_t number) {
  const auto [first, last] = numbers_meant(number);
  for (std::size_t motor = 0; motor < values_.size(); ++motor) {
    for (auto n = first; n <= last; ++n) load(motor, n);
  }
}

}  // namespace tmcl::sim

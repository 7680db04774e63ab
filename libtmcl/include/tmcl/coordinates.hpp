/// Positions that a module remembers by number, and moves to them.
#pragma once

#include <cstdint>
#include <optional>

#include "tmcl/address.hpp"
#include "tmcl/script.hpp"
#include "tmcl/units.hpp"

namespace tmcl {

/// Coordinates 0 to 20 of each motor; 0 is never stored.
constexpr std::uint8_t greatest_coordinate = 20;

/// Motors of one module that start to move together: bit n is motor n, for the first six.
struct MotorMask {
  std::uint8_t bits = 0;  ///< 1..63
};

/// How motors that start together go.
enum class Together : std::uint8_t {
  each_for_itself,  ///< Each with its own velocity.
  interpolated,     ///< Velocities are scaled so that all of them arrive together.
};

namespace verbs {

/// Remembers a position (SCO); lost when the module loses power, unless global parameter 84 is 1.
Script<Result<void>> set_coordinate(AxisAddress axis, std::uint8_t number, Microsteps position);
/// Reads a coordinate (GCO).
Script<Result<Microsteps>> coordinate(AxisAddress axis, std::uint8_t number);
/// Remembers where the axis is (CCO), and gives that back.
Script<Result<Microsteps>> capture_coordinate(AxisAddress axis, std::uint8_t number);
/// Copies a coordinate of all motors to the EEPROM (SCO with motor 255); nothing: all of them.
/// The manuals give the forms `SCO n, 255, 0` for one and `SCO 0, 255, 0` for all.
Script<Result<void>> store_coordinates(ModuleAddress module,
                                       std::optional<std::uint8_t> number = {});
/// And back (GCO with motor 255).
Script<Result<void>> load_coordinates(ModuleAddress module,
                                      std::optional<std::uint8_t> number = {});

/// Starts a move to a coordinate (MVP COORD).
Script<Result<void>> move_to_coordinate(AxisAddress axis, std::uint8_t number);
/// Starts several motors of a module together, each to its own coordinate of this number. The motor
/// byte is 64 plus the mask for interpolation (the vendor's word: TMCL-IDE-Nightly, issue 2), and
/// 128 plus the mask without, which no public document settles.
Script<Result<void>> move_motors_to_coordinate(ModuleAddress module, MotorMask motors,
                                               Together together, std::uint8_t number);

}  // namespace verbs
}  // namespace tmcl

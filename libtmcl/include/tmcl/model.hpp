/// The modules this library knows by name.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace tmcl {

/// Modules of a family share a ramp generator and the meaning of their parameter numbers. The same
/// number may mean something else in another family.
enum class Family : std::uint8_t {
  tmc429,    ///< Trapezoids; velocities -2047..2047 that dividers scale.
  tmc457,    ///< S-shaped ramps; 32-bit registers, or microsteps per second.
  sixpoint,  ///< The TMC5130 and its relatives; microsteps per second, or the chip's units.
  tmc4361,   ///< S-shaped ramps and closed loop; always microsteps per second.
  firmware,  ///< Trapezoids that the firmware makes; always microsteps per second.
};
inline constexpr std::array families{Family::tmc429, Family::tmc457, Family::sixpoint,
                                     Family::tmc4361, Family::firmware};
/// "TMC429", or what else makes the ramps.
std::string_view name_of(Family family);

/// How a host reaches a module: bits.
enum Interface : std::uint8_t { usb = 1, rs232 = 2, rs485 = 4, can = 8 };

/// The inputs and outputs of a module, as GIO and SIO number them.
struct Ports {
  std::uint8_t digital_inputs = 0;  ///< How many; bank 0.
  std::uint16_t analog_inputs = 0;  ///< Bit n for port n of bank 1.
  std::uint8_t outputs = 0;         ///< How many; bank 2.
};

struct Model {
  std::uint16_t number;   ///< What the firmware reports, such as 1110.
  std::string_view name;  ///< "TMCM-1110"; what follows the '-' is the number.
  std::uint8_t axes;
  Family family;
  std::uint8_t interfaces = 0;  ///< Bits of Interface, as far as they are known.
  Ports ports = {};             ///< As far as they are known.
  std::string_view chips = {};  ///< What moves its motors: "TMC429, TMC262".
};

/// Ascending by number.
std::span<const Model> models();
/// Null for a model that is not known.
const Model* find_model(std::uint16_t number);
/// "TMCM-1110", "tmcm1110" and "1110" are one, as are "PD-146" and "146". Null for a model that is
/// not known.
const Model* find_model(std::string_view name);

}  // namespace tmcl

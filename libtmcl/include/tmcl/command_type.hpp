/// The types of commands that move a motor: the byte behind the command's number. From the TMCL
/// firmware manuals; command.hpp names those of all commands.
#pragma once

#include <cstdint>

namespace tmcl {

/// Of MVP and MVPA.
namespace move_type {
constexpr std::uint8_t absolute = 0;
constexpr std::uint8_t relative = 1;
constexpr std::uint8_t coordinate = 2;
}  // namespace move_type

/// The motor field of MVP and MVPA COORD for several motors: one of the first two, and a bit for
/// each.
namespace motor_mask {
constexpr std::uint8_t each_for_itself = 0x80;
constexpr std::uint8_t interpolated = 0x40;
constexpr std::uint8_t motors = 6;  ///< The first six have a bit.
}  // namespace motor_mask

/// Of RFS.
namespace search_type {
constexpr std::uint8_t start = 0;
constexpr std::uint8_t stop = 1;
constexpr std::uint8_t status = 2;
}  // namespace search_type

}  // namespace tmcl

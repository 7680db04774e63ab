/// In what a TMC429 counts.
#pragma once

#include <cstdint>

#include "motion/ramp/integer.hpp"

namespace tmcl::ramp {

constexpr std::uint32_t step_unit = 2048;          // overflow of the pulse accumulator
constexpr std::uint32_t distance_limit = 1 << 19;  // the deceleration looks no further ahead
constexpr unsigned position_bits = 24;
constexpr std::int32_t half_turn = 1 << (position_bits - 1);  // of the position counter

constexpr std::int32_t wrap24(std::int64_t x) {
  return static_cast<std::int32_t>(sign_extend(static_cast<std::uint64_t>(x), position_bits));
}

}  // namespace tmcl::ramp

/// How the parts of a movement are called.
#pragma once

#include <array>
#include <string_view>

#include "tmcl/ramp/cubic_track.hpp"

namespace tmcl::ramp {

constexpr std::string_view s_curve_name(Part part) {
  constexpr std::array<std::string_view, 8> names{"I", "II", "III", "IV", "V", "VI", "VII", "rest"};
  return names[static_cast<std::size_t>(part)];
}

/// As the data sheet of the TMC4361 numbers them: by the bows, and what lies between two of them.
constexpr std::string_view bow_name(Part part) {
  constexpr std::array<std::string_view, 8> names{"B1", "B12", "B2", "B23",
                                                  "B3", "B34", "B4", "rest"};
  return names[static_cast<std::size_t>(part)];
}

/// A trapezoid has no jerk, so only three of the parts.
constexpr std::string_view trapezoid_name(Part part) {
  switch (part) {
    case Part::ii: return "accelerate";
    case Part::vi: return "decelerate";
    case Part::rest: return "rest";
    default: return "cruise";
  }
}

}  // namespace tmcl::ramp

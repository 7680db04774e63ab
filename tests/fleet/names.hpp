/// What the simulated gateways and their client have to agree on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

namespace tmclfleet {

constexpr int axes_of_a_gateway = 6;

inline std::string name_of_axis(int motor) { return {static_cast<char>('a' + motor)}; }

/// Four digits: "g0042".
inline std::string name_of_gateway(int number) {
  const auto digits = std::to_string(number);
  return 'g' + std::string(4 - std::min<std::size_t>(digits.size(), 4), '0') + digits;
}

}  // namespace tmclfleet

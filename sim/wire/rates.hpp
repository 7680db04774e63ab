/// The bit rates behind the codes of global parameters 65 (serial) and 69 (CAN).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tmcl::sim {

/// Bits per second; 0 for a code that there is not.
constexpr std::uint32_t serial_rate(std::int32_t code) {
  constexpr std::array<std::uint32_t, 12> rates{9'600,   14'400,  19'200,  28'800,
                                                38'400,  57'600,  76'800,  115'200,
                                                230'400, 250'000, 500'000, 1'000'000};
  return code >= 0 && static_cast<std::size_t>(code) < rates.size()
             ? rates[static_cast<std::size_t>(code)]
             : 0;
}

constexpr std::uint32_t can_rate(std::int32_t code) {
  constexpr std::array<std::uint32_t, 9> rates{0,       10'000,  20'000,  50'000,   100'000,
                                               125'000, 250'000, 500'000, 1'000'000};
  return code >= 0 && static_cast<std::size_t>(code) < rates.size()
             ? rates[static_cast<std::size_t>(code)]
             : 0;
}

}  // namespace tmcl::sim

/// The bit rates behind the codes of global parameters 65 (serial) and 69 (CAN).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tmcl::sim {

template <std::size_t Count>
constexpr std::uint32_t rate_of_code(const std::array<std::uint32_t, Count>& rates,
                                     std::int32_t code) {
  const bool exists = code >= 0 && static_cast<std::size_t>(code) < Count;
  return exists ? rates[static_cast<std::size_t>(code)] : 0;
}

/// Bits per second; 0 for a code that there is not.
constexpr std::uint32_t serial_rate(std::int32_t code) {
  return rate_of_code<12>({9'600, 14'400, 19'200, 28'800, 38'400, 57'600, 76'800, 115'200, 230'400,
                           250'000, 500'000, 1'000'000},
                          code);
}

constexpr std::uint32_t can_rate(std::int32_t code) {
  return rate_of_code<9>({0, 10'000, 20'000, 50'000, 100'000, 125'000, 250'000, 500'000, 1'000'000},
                         code);
}

}  // namespace tmcl::sim

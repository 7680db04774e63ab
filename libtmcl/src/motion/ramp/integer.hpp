/// Integer arithmetic that the generators share.
#pragma once

#include <cmath>
#include <cstdint>

namespace tmcl::ramp {

/// The low `bits` bits as a signed number: how a counter of that width wraps.
constexpr std::int64_t sign_extend(std::uint64_t value, unsigned bits) {
  const auto unused = 64U - bits;
  return static_cast<std::int64_t>(value << unused) >> unused;
}

constexpr std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

/// Below 2^52. The root of a number just under a square does not round up to the next integer.
inline std::uint64_t integer_root(std::uint64_t m) {
  return static_cast<std::uint64_t>(std::sqrt(static_cast<double>(m)));
}

/// The sum of floor((a i + b) / m) for i = 0 .. n-1, as Euclid would do it. The caller sees to it
/// that a n + b and the sum fit 32 bits.
constexpr std::uint32_t floor_sum(std::uint32_t n, std::uint32_t m, std::uint32_t a,
                                  std::uint32_t b) {
  std::uint32_t sum = 0;
  while (n != 0) {
    const auto pairs = static_cast<std::uint32_t>(std::uint64_t{n} * (n - 1) / 2);
    sum += pairs * (a / m) + n * (b / m);
    a %= m;
    b %= m;
    const auto last = a * n + b;
    if (last < m) break;
    n = last / m;
    b = last % m;
    const auto modulus = m;
    m = a;
    a = modulus;
  }
  return sum;
}

}  // namespace tmcl::ramp

/// What is between a host and the modules of a serial line.
#pragma once

#include <cstdint>
#include <random>
#include <span>

#include "sim/wire/pace.hpp"

namespace tmcl::sim {

/// Without anything set it is a perfect one: every byte is heard at once, as it was sent.
struct SerialWire {
  Pace pace{};  ///< Its rate is that of the host.
  /// With a pace: modules speak and hear at the rate of their global parameter 65, and what is said
  /// at another one is garbage.
  bool has_rates_of_modules = false;
  bool echoes = false;     ///< The host's adapter hears what it says, as on two wires it may.
  double noise = 0;        ///< How likely a byte has a wrong bit, 0 to 1, in each direction.
  std::uint64_t seed = 0;  ///< Of noise and garbage.
};

/// What becomes of bytes on the way.
class Disturbance {
 public:
  Disturbance(double noise, std::uint64_t seed) : random_(seed), hits_(noise) {}

  /// By noise: one wrong bit here and there.
  void disturb(std::span<std::uint8_t> bytes) {
    for (auto& byte : bytes)
      if (hits_.p() > 0 && hits_(random_))
        byte = static_cast<std::uint8_t>(byte ^ 1U << draw() % 8);
  }
  /// By another rate, or by another speaker at the same time.
  void garble(std::span<std::uint8_t> bytes) {
    for (auto& byte : bytes) byte = garbage();
  }
  std::uint8_t garbage() { return static_cast<std::uint8_t>(draw()); }

 private:
  std::uint64_t draw() { return random_() >> 32U; }

  std::mt19937_64 random_;
  std::bernoulli_distribution hits_;
};

}  // namespace tmcl::sim

/// What positions tell of a load that swings behind a motor that stands: how fast, and how soon
/// that ends.
///
///     p(t) = c + e^(-d w t) (a cos(w' t) + b sin(w' t)),   w = 2 pi f,   w' = w sqrt(1 - d^2)
///
/// Fitted to positions at any times, by least squares. Whatever is read a number of times a second
/// tells nothing of what swings faster than some part of that: `highest_hz` says of what. Times
/// that are not evenly spaced keep such a swing from looking like a slower one.
#pragma once

#include <cstdint>
#include <span>

#include "tmcl/ramp/resonant_load.hpp"

namespace tmcl::plan {

struct PositionAt {
  double time_s = 0;
  double position = 0;
};

/// More are not looked at. Finding takes a time that grows with their square.
constexpr std::size_t most_ring_down_positions = 800;
constexpr std::size_t least_ring_down_positions = 16;

struct RingDown {
  enum class Verdict : std::uint8_t {
    rings,    ///< The resonance and the swing are known.
    still,    ///< The positions vary by no more than one step of what reads them.
    unclear,  ///< They vary otherwise: noise, or what swings too fast or too slowly to be seen.
    too_few,  ///< There are fewer than least_ring_down_positions.
  };
  Verdict verdict = Verdict::too_few;
  ramp::Resonance resonance;
  double swing = 0;       ///< How far to either side at the first time.
  double confidence = 0;  ///< The part of what they did until it had died down, 0 to 1.
  double lowest_hz = 0;   ///< Between these a swing is seen.
  double highest_hz = 0;
};

/// The times ascend.
RingDown ring_down(std::span<const PositionAt> positions);
/// Other positions of the same time swing so, too, as far as they are enough to tell.
bool explains(const ramp::Resonance& resonance, std::span<const PositionAt> positions);

}  // namespace tmcl::plan

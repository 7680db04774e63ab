/// Input shaping: a course is passed as the sum of some of its parts, one after the other, so that
/// what each part makes a load swing is undone by the next ones. Singer and Seering, "Preshaping
/// command inputs to reduce system vibration", 1990; Singhose, Seering and Singer, "Residual
/// vibration reduction using vector diagrams to generate shaped inputs", 1994.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tmcl/ramp/resonant_load.hpp"

namespace tmcl::plan {

enum class Shaper : std::uint8_t {
  zv,   ///< No swing is left at the resonance: half a swing longer.
  zvd,  ///< Little is left near it, too: a whole swing longer.
  ei,   ///< As long; 5 % are left at it, and no more in a wider range around it.
};
/// "zvd"; part of the stable interface.
std::string_view name_of(Shaper shaper);
std::optional<Shaper> shaper_named(std::string_view name);

struct Shaping {
  Shaper shaper = Shaper::zvd;
  ramp::Resonance resonance;
};

struct Impulse {
  double delay = 0;  ///< In seconds.
  double part = 1;   ///< Of the whole; greater than 0.
};

/// Ascending by delay, the first one at 0; the parts make 1.
std::vector<Impulse> impulses_of(const Shaping& shaping);

/// How much longer a movement takes.
inline double longest_delay(const std::vector<Impulse>& impulses) {
  return impulses.empty() ? 0 : impulses.back().delay;
}
/// By how much it comes later, on average.
double mean_delay(const std::vector<Impulse>& impulses);

}  // namespace tmcl::plan

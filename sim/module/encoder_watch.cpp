#include "sim/module/encoder_watch.hpp"

#include <cmath>
#include <cstdlib>

namespace tmcl::sim {
namespace {

// No motor goes so far.
constexpr double farthest = 0x1p40;

}  // namespace

// The encoder's position grows in steps. Far from the limit only the difference between the two
// speeds matters; near to it, each step is a place to look again.
void EncoderWatch::limit(Reach& reach, std::int64_t deviation, const Coupling& coupling) const {
  const double ratio = static_cast<double>(coupling.counts() * scale_.microsteps) /
                       static_cast<double>(coupling.microsteps() * scale_.counts);
  const auto step = coupling.counts() == 0 ? 0 : scale_.greatest_step();
  const auto room = most_ - std::abs(deviation) - step;
  const double drift = std::abs(1 - ratio);
  const double way = static_cast<double>(room);
  if (coupling.counts() != 0 && room > 0 && way >= drift) {
    if (way >= drift * farthest) return;
    reach.limit_back(static_cast<std::int64_t>(way / drift));
    reach.limit_ahead(static_cast<std::int64_t>(way / drift));
    return;
  }
  const auto next = coupling.counts() == 0 ? Reach{} : coupling.reach_of_encoder();
  reach.limit_back(std::min(next.back, most_ + deviation));
  reach.limit_ahead(std::min(next.ahead, most_ - deviation));
}

}  // namespace tmcl::sim

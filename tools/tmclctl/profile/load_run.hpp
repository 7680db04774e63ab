/// What becomes of a load that is joined to the motor by something that gives.
#pragma once

#include <optional>
#include <vector>

#include "plot/recording.hpp"
#include "tmcl/ramp/resonant_load.hpp"

namespace tmclctl::profile {

struct LoadWish {
  tmcl::ramp::Resonance resonance;
  std::optional<double>
      tolerance{};  ///< In the unit that is drawn; a thousandth of the way without.
};

/// In the unit that is drawn.
struct LoadRun {
  std::vector<double> times;  ///< Those of the motor, and some swings after it stands.
  std::vector<double> positions;
  std::vector<double> velocities;
  double swing = 0;  ///< To either side, when the motor has arrived.
  std::optional<double>
      settled{};  ///< When it swings within the tolerance; nothing if it never does.
};

LoadRun follow_load(const plot::Recording& recording, const LoadWish& wish);

}  // namespace tmclctl::profile

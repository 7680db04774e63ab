/// The ramps that an axis is tried with.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tmcl/plan/ramp_wish.hpp"
#include "tmcl/quantity.hpp"
#include "tmcl/ramp/resonant_load.hpp"
#include "tmcl/script.hpp"
#include "tmcl/tuning.hpp"

namespace tmcl::verbs {

/// That a way is longer than its ramps and its time at full speed.
constexpr double full_steps_beyond = 8;

struct TrialRamps {
  const TuneOptions& options;
  const Tuning& found;
  double full_step = 256;  ///< In microsteps.
  double base_acceleration = 0;

  /// What the axis had before; 0 for what its module does not have.
  std::int32_t present(std::uint8_t parameter) const;
  /// Nothing for what the module cannot do.
  std::optional<plan::PlannedRamp> ramp_of(double velocity, double acceleration) const;
  std::optional<plan::PlannedRamp> ramp_for(Sought sought, double value) const;
  /// At the proposed velocity and acceleration.
  std::optional<plan::PlannedRamp> bowed_ramp(std::int32_t bow, const AxisUnits& units) const;
  /// Both ramps, and some time at full speed.
  std::int32_t way_of(const plan::PlannedRamp& ramp) const;
  Script<std::int32_t> first_settled_bow(ramp::Resonance resonance, std::int32_t room) const;

 private:
  const Model& model() const { return *options.units.model; }
  std::vector<std::int32_t> gentler_bows(std::int32_t room) const;
  std::optional<double> settled_s(std::int32_t bow, double way,
                                  const ramp::Resonance& resonance) const;
};

/// How long such a way takes at most.
Duration limit_of(const plan::PlannedRamp& ramp, std::int32_t way);

}  // namespace tmcl::verbs

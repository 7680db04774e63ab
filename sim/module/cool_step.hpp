/// coolStep: the driver takes as little current as the load allows.
#pragma once

#include <cstdint>
#include <optional>

namespace tmcl::sim {

/// As axis parameters 168 to 172 have them; the data sheets call them SEIMIN, SEDN, SEMAX, SEUP and
/// SEMIN.
struct CoolStepSettings {
  std::int32_t minimum = 0;
  std::int32_t down_step = 0;
  std::int32_t hysteresis = 0;
  std::int32_t up_step = 0;
  std::int32_t hysteresis_start = 0;  ///< 0: no coolStep.
};

class CoolStep {
 public:
  /// With the full current again.
  void reset();
  /// The load was measured once more. `run_scale`: the current that is set, 0..31.
  void take(std::int32_t load_value, std::int32_t run_scale, const CoolStepSettings& settings);
  /// The current to which a set one comes down.
  std::int32_t scale(std::int32_t run_scale, const CoolStepSettings& settings) const;

 private:
  std::optional<std::int32_t> scale_;  // none: as it is set
  int high_readings_ = 0;              // since the current went down last
};

}  // namespace tmcl::sim

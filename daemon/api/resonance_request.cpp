#include "api/resonance_request.hpp"

#include "api/number_within.hpp"

namespace tmcld {

namespace plan = tmcl::plan;

Task<std::optional<plan::Resonance>> resonance_of(std::optional<double> frequency_hz,
                                                  std::optional<double> damping) {
  if (!frequency_hz) co_return std::nullopt;
  plan::Resonance resonance;
  resonance.frequency_hz = co_await must(number_within(
      "resonance_hz", *frequency_hz, plan::least_resonance_hz, plan::greatest_resonance_hz));
  resonance.damping = co_await must(number_within(
      "damping", damping.value_or(plan::usual_load_damping), 0, plan::greatest_load_damping));
  co_return resonance;
}

}  // namespace tmcld

#include "api/resonance_request.hpp"

#include "api/number_within.hpp"

namespace tmcld {

Task<std::optional<tmcl::ramp::Resonance>> resonance_of(std::optional<double> frequency_hz,
                                                        std::optional<double> damping) {
  if (!frequency_hz) co_return std::nullopt;
  tmcl::ramp::Resonance resonance;
  resonance.frequency_hz =
      co_await must(number_within("resonance_hz", *frequency_hz, tmcl::ramp::least_resonance_hz,
                                  tmcl::ramp::greatest_resonance_hz));
  resonance.damping =
      co_await must(number_within("damping", damping.value_or(tmcl::ramp::usual_load_damping), 0,
                                  tmcl::ramp::greatest_load_damping));
  co_return resonance;
}

}  // namespace tmcld

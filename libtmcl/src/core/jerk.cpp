#include "tmcl/jerk.hpp"

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace tmcl {
namespace {

constexpr double clock_hz = 16e6;

/// "mm/s^2" of "mm/s^3"; empty of a unit that is not per second.
std::string once_less_per_second(std::string_view unit) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> endings{{
      {"/s/s/s", "/s/s"},
      {"/s^3", "/s^2"},
      {"/s3", "/s2"},
      {"/s/s", "/s"},
      {"/s^2", "/s"},
      {"/s2", "/s"},
      {"/s", ""},
  }};
  for (const auto& [ending, shorter] : endings) {
    if (!unit.ends_with(ending)) continue;
    unit.remove_suffix(ending.size());
    return std::string(unit) + std::string(shorter);
  }
  return {};
}

}  // namespace

PulsesPerSecond3 to_pps3(std::int32_t bow) {
  return {std::ldexp(clock_hz * clock_hz * clock_hz, bow - 1 - 52)};
}

std::int32_t bow_within(PulsesPerSecond3 jerk) {
  std::int32_t bow = 1;
  while (bow < greatest_bow && to_pps3(bow + 1) <= jerk) ++bow;
  return bow;
}

double seconds_to(PulsesPerSecond2 acceleration, PulsesPerSecond3 jerk) {
  return acceleration.value / jerk.value;
}

RampLength ramp_length(PulsesPerSecond velocity, PulsesPerSecond2 acceleration,
                       PulsesPerSecond3 jerk) {
  const double v = velocity.value;
  const double a = acceleration.value;
  const double j = jerk.value;
  double seconds = v / a;
  if (std::isfinite(j)) seconds = v * j >= a * a ? seconds + a / j : 2 * std::sqrt(v / j);
  return {seconds, v * seconds / 2};
}

bool may_oscillate(std::int32_t bow, PulsesPerSecond2 acceleration) {
  constexpr auto unit = tmc457_acceleration_unit;
  const double in_register = acceleration.value * static_cast<double>(unit.denominator) /
                             static_cast<double>(unit.numerator);
  return bow > 0 && std::ldexp(1.0, bow) >= in_register;
}

bool is_jerk(const Quantity& quantity) {
  const auto of_velocity = once_less_per_second(once_less_per_second(quantity.unit));
  return dimension_of(Quantity{0, of_velocity}) == Dimension::velocity;
}

Result<PulsesPerSecond3> to_pps3(const Quantity& quantity, const AxisUnits& units) {
  if (!is_jerk(quantity)) {
    const auto own = units.has_unit() ? "1000" + units.scale->unit + "/s^3, " : std::string();
    return tl::unexpected(not_sent(Errc::wrong_unit, "'" + to_string(quantity) + "' is no jerk",
                                   "That is such as " + own + "1000pps/s^2, 10rps/s^2"));
  }
  return to_pps2({quantity.number, once_less_per_second(quantity.unit)}, units)
      .map([](PulsesPerSecond2 change) { return PulsesPerSecond3{change.value}; });
}

}  // namespace tmcl

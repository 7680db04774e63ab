#include "sim/module/cool_step.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tmcl::sim {
namespace {

// Of SMARTEN (TMC26x) and COOLCONF (TMC5130), as the vendor describes the registers in its headers.
constexpr std::int32_t threshold_unit = 32;
constexpr auto increments = std::to_array<std::int32_t>({1, 2, 4, 8});
constexpr auto readings_per_decrement = std::to_array<int>({32, 8, 2, 1});

template <class Codes>
auto decoded(const Codes& codes, std::int32_t code) {
  return codes[static_cast<std::size_t>(code) % codes.size()];
}

// A half, or a quarter, of what is set.
std::int32_t least_scale(std::int32_t run_scale, const CoolStepSettings& settings) {
  return run_scale / (settings.minimum == 0 ? 2 : 4);
}

}  // namespace

void CoolStep::reset() { *this = {}; }

std::int32_t CoolStep::scale(std::int32_t run_scale, const CoolStepSettings& settings) const {
  if (!scale_) return run_scale;
  return std::clamp(*scale_, least_scale(run_scale, settings), run_scale);
}

void CoolStep::take(std::int32_t load_value, std::int32_t run_scale,
                    const CoolStepSettings& settings) {
  const auto lower = threshold_unit * settings.hysteresis_start;
  const auto upper = threshold_unit * (settings.hysteresis_start + settings.hysteresis + 1);
  auto now = scale(run_scale, settings);
  if (load_value < lower) {
    now += decoded(increments, settings.up_step);
    high_readings_ = 0;
  } else if (load_value < upper) {
    high_readings_ = 0;
  } else if (++high_readings_ >= decoded(readings_per_decrement, settings.down_step)) {
    now -= 1;
    high_readings_ = 0;
  }
  scale_ = now;
  scale_ = scale(run_scale, settings);
}

}  // namespace tmcl::sim

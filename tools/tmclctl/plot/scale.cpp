#include "plot/scale.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tmclctl::plot {
namespace {

// 1, 2 or 5 times a power of ten, and at least `step`.
double round_step(double step) {
  const double magnitude = std::pow(10, std::floor(std::log10(step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * magnitude >= step * 0.999) return factor * magnitude;
  }
  return 10 * magnitude;
}

std::vector<double> multiples_within(double step, double low, double high) {
  std::vector<double> ticks;
  const double slack = step * 1e-6;
  for (double n = std::ceil((low - slack) / step); n * step <= high + slack; ++n)
    ticks.push_back(n * step + 0.0);
  return ticks;
}

}  // namespace

Scale::Scale(std::span<const double> values, int ticks_wished) {
  if (!values.empty()) {
    const auto [least, greatest] = std::ranges::minmax(values);
    low_ = least;
    high_ = greatest;
  }
  // A line without height is drawn in the middle.
  if (high_ - low_ < 1e-9) {
    low_ -= 1;
    high_ += 1;
  }
  double step = round_step((high_ - low_) / ticks_wished);
  ticks_ = multiples_within(step, low_, high_);
  while (ticks_.size() < 2) {
    step = round_step(step / 2.5);  // the next smaller one, for any of them
    ticks_ = multiples_within(step, low_, high_);
  }
  decimals_ = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
}

std::string Scale::label(double tick) const { return fmt::format("{:.{}f}", tick, decimals_); }

}  // namespace tmclctl::plot

#include "tmcl/plan/shaping.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "tmcl/ensure.hpp"

namespace tmcl::plan {
namespace {

struct Named {
  Shaper shaper;
  std::string_view name;
};
constexpr std::array names{Named{Shaper::zv, "zv"}, Named{Shaper::zvd, "zvd"},
                           Named{Shaper::ei, "ei"}};

/// What an EI shaper leaves of a swing at the resonance itself.
constexpr double left_at_resonance = 0.05;

/// Of a load without damping.
std::vector<double> parts_of(Shaper shaper) {
  switch (shaper) {
    case Shaper::zv: return {1, 1};
    case Shaper::zvd: return {1, 2, 1};
    case Shaper::ei: break;
  }
  return {(1 + left_at_resonance) / 4, (1 - left_at_resonance) / 2, (1 + left_at_resonance) / 4};
}

}  // namespace

std::string_view name_of(Shaper shaper) { return names.at(static_cast<std::size_t>(shaper)).name; }

std::optional<Shaper> shaper_named(std::string_view name) {
  for (const auto& known : names) {
    if (known.name == name) return known.shaper;
  }
  return std::nullopt;
}

std::vector<Impulse> impulses_of(const Shaping& shaping) {
  const auto [frequency, damping] = shaping.resonance;
  ensure(frequency > 0 && damping >= 0 && damping < 1);
  const double root = std::sqrt(1 - damping * damping);
  const double half_a_swing = 0.5 / (frequency * root);
  // In half a swing it shrinks to this: the next part has so much less to undo.
  const double shrunk = std::exp(-damping * std::numbers::pi / root);
  std::vector<Impulse> impulses;
  double factor = 1, sum = 0;
  for (const double part : parts_of(shaping.shaper)) {
    impulses.push_back({static_cast<double>(impulses.size()) * half_a_swing, part * factor});
    sum += part * factor;
    factor *= shrunk;
  }
  for (auto& impulse : impulses) impulse.part /= sum;
  return impulses;
}

double mean_delay(const std::vector<Impulse>& impulses) {
  double mean = 0;
  for (const auto& impulse : impulses) mean += impulse.part * impulse.delay;
  return mean;
}

}  // namespace tmcl::plan

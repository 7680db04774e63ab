#include "tmcl/plan/ring_down.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace tmcl::plan {
namespace {

// Of a swing so many positions are needed, or it may be a faster one.
constexpr double positions_of_a_swing = 2.5;
// Of the frequencies that positions over some time tell apart, so many are tried in each.
constexpr double tries = 4;
constexpr std::array dampings{0.005, 0.05, 0.2, 0.5};
constexpr double greatest_damping = 0.8;
constexpr std::size_t candidates = 4;
constexpr double least_confidence = 0.85;
// After so many times in which it shrinks to 1/e, a swing is not worth looking at.
constexpr double decays_looked_at = 4;
// What is gone sooner is in too few positions to be a swing.
constexpr double least_positions_of_decay = 2;
constexpr double finest_step = 1e-6;
// Near to the highest frequency it may be a faster swing that seems slower.
constexpr double sure_part = 0.95;

using Matrix = std::array<std::array<double, 4>, 3>;

/// By elimination; the last column becomes the solution. False where there is none.
bool solve(Matrix& rows) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto pivot = std::max_element(
        rows.begin() + static_cast<std::ptrdiff_t>(i), rows.end(),
        [i](const auto& a, const auto& b) { return std::abs(a[i]) < std::abs(b[i]); });
    std::swap(rows[i], *pivot);
    if (std::abs(rows[i][i]) < 1e-12) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == i) continue;
      const double part = rows[k][i] / rows[i][i];
      for (std::size_t j = i; j < 4; ++j) rows[k][j] -= part * rows[i][j];
    }
  }
  for (std::size_t i = 0; i < 3; ++i) rows[i][3] /= rows[i][i];
  return true;
}

/// How well a swing explains the positions, and how great it is then.
struct Fit {
  ramp::Resonance resonance;
  double left = std::numeric_limits<double>::infinity();  ///< Squares that it does not explain.
  double swing = 0;
};

/// Times from 0 on, and positions around their mean.
class Readings {
 public:
  explicit Readings(std::span<const PositionAt> positions)
      : at_(positions.begin(), positions.end()) {
    const double begin = at_.front().time_s;
    double mean = 0;
    for (const auto& one : at_) mean += one.position / static_cast<double>(at_.size());
    for (auto& one : at_) {
      one.time_s -= begin;
      one.position -= mean;
      squares_ += one.position * one.position;
    }
  }

  double span_s() const { return at_.back().time_s; }
  double squares() const { return squares_; }

  Fit fit(ramp::Resonance resonance) const {
    const double natural = 2 * std::numbers::pi * resonance.frequency_hz;
    const double decay = natural * resonance.damping;
    const double swinging = natural * std::sqrt(1 - resonance.damping * resonance.damping);
    Matrix rows{};
    for (const auto& [time, position] : at_) {
      const double shrunk = std::exp(-decay * time);
      const std::array<double, 4> row{1, shrunk * std::cos(swinging * time),
                                      shrunk * std::sin(swinging * time), position};
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) rows[i][j] += row[i] * row[j];
    }
    const std::array<double, 3> products{rows[0][3], rows[1][3], rows[2][3]};
    Fit fit{resonance};
    if (!solve(rows)) return fit;
    fit.left = squares_;
    for (std::size_t i = 0; i < 3; ++i) fit.left -= rows[i][3] * products[i];
    fit.left = std::max(fit.left, 0.0);
    fit.swing = std::hypot(rows[1][3], rows[2][3]);
    return fit;
  }

 private:
  std::vector<PositionAt> at_;
  double squares_ = 0;
};

bool is_better(const Fit& a, const Fit& b) { return a.left < b.left; }

/// The best of all that are tried, no two of them neighbours.
std::vector<Fit> best_of_grid(const Readings& readings, double lowest, double highest) {
  const double step = 1 / (tries * readings.span_s());
  std::vector<Fit> along;
  for (double frequency = lowest; frequency <= highest; frequency += step) {
    Fit best;
    for (const double damping : dampings)
      best = std::min(best, readings.fit({frequency, damping}), is_better);
    along.push_back(best);
  }
  std::vector<Fit> peaks;
  for (std::size_t i = 0; i < along.size(); ++i) {
    const bool rises = i > 0 && is_better(along[i - 1], along[i]);
    const bool falls = i + 1 < along.size() && is_better(along[i + 1], along[i]);
    if (!rises && !falls) peaks.push_back(along[i]);
  }
  std::ranges::sort(peaks, is_better);
  peaks.resize(std::min(peaks.size(), candidates));
  return peaks;
}

/// By steps that become smaller where none of them helps.
Fit refined(const Readings& readings, Fit best, double highest) {
  double by_frequency = 1 / (tries * readings.span_s());
  double by_damping = 0.5;
  const double finest = finest_step * best.resonance.frequency_hz;
  while (by_frequency > finest) {
    const auto [frequency, damping] = best.resonance;
    const auto before = best.left;
    for (const auto& [f, d] : {std::pair{frequency + by_frequency, damping},
                               std::pair{frequency - by_frequency, damping},
                               std::pair{frequency, damping * (1 + by_damping)},
                               std::pair{frequency, damping / (1 + by_damping)}}) {
      if (f <= 0 || f > highest || d > greatest_damping) continue;
      best = std::min(best, readings.fit({f, d}), is_better);
    }
    if (best.left < before) continue;
    by_frequency /= 2;
    by_damping /= 2;
  }
  return best;
}

double decay_s(const ramp::Resonance& resonance) {
  return 1 / (2 * std::numbers::pi * resonance.frequency_hz * resonance.damping);
}

/// Of all that are seen in these positions.
Fit best_fit(const Readings& readings, double lowest, double highest) {
  Fit best;
  for (const auto& peak : best_of_grid(readings, lowest, highest))
    best = std::min(best, refined(readings, peak, highest), is_better);
  return best;
}

/// Until the swing has died down: what comes then is noise.
std::span<const PositionAt> while_it_swings(std::span<const PositionAt> positions,
                                            const ramp::Resonance& resonance) {
  const double end = positions.front().time_s + decays_looked_at * decay_s(resonance);
  const auto within =
      std::ranges::count_if(positions, [&](const PositionAt& one) { return one.time_s < end; });
  return positions.first(std::max(static_cast<std::size_t>(within), least_ring_down_positions));
}

/// They vary by no more than the least difference between two of them.
bool stands(std::span<const PositionAt> positions) {
  std::vector<double> values;
  for (const auto& one : positions) values.push_back(one.position);
  std::ranges::sort(values);
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i] > values[i - 1]) step = std::min(step, values[i] - values[i - 1]);
  return !(values.back() - values.front() > step);
}

}  // namespace

bool explains(const ramp::Resonance& resonance, std::span<const PositionAt> positions) {
  if (positions.size() < least_ring_down_positions) return true;
  const Readings swings(while_it_swings(positions, resonance));
  return swings.fit(resonance).left <= (1 - least_confidence) * swings.squares();
}

RingDown ring_down(std::span<const PositionAt> positions) {
  positions = positions.first(std::min(positions.size(), most_ring_down_positions));
  RingDown found;
  if (positions.size() < least_ring_down_positions ||
      positions.back().time_s <= positions.front().time_s)
    return found;
  const Readings readings(positions);
  found.lowest_hz = 1 / readings.span_s();
  found.highest_hz =
      static_cast<double>(positions.size() - 1) / readings.span_s() / positions_of_a_swing;
  found.verdict = RingDown::Verdict::still;
  if (stands(positions)) return found;
  found.verdict = RingDown::Verdict::unclear;
  const auto seen = best_fit(readings, found.lowest_hz, found.highest_hz);
  const Readings swings(while_it_swings(positions, seen.resonance));
  const auto best = refined(swings, swings.fit(seen.resonance), found.highest_hz);
  if (swings.squares() > 0)
    found.confidence = std::clamp(1 - best.left / swings.squares(), 0.0, 1.0);
  const double frequency = best.resonance.frequency_hz;
  const double interval = readings.span_s() / static_cast<double>(positions.size() - 1);
  if (found.confidence < least_confidence || frequency > sure_part * found.highest_hz ||
      frequency < sure_part * found.lowest_hz ||
      decay_s(best.resonance) < least_positions_of_decay * interval)
    return found;
  found.verdict = RingDown::Verdict::rings;
  found.resonance = best.resonance;
  found.swing = best.swing;
  return found;
}

}  // namespace tmcl::plan

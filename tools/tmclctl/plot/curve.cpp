#include "plot/curve.hpp"

#include <algorithm>
#include <utility>

namespace tmclctl::plot {
namespace {

// Of the points between two breaks: values that were rounded do not change evenly.
constexpr std::size_t parts_of_a_piece = 16;

/// Points between two breaks, the last one included.
struct Piece {
  std::size_t begin;
  std::size_t end;

  std::size_t size() const { return end - begin; }
  /// Without its ends, where the values may have jumped.
  Piece inner() const { return size() < 3 ? Piece{begin, begin + 1} : Piece{begin + 1, end - 1}; }
};

double slope(const Curve& curve, std::size_t from, std::size_t to) {
  const double time = curve.times[to] - curve.times[from];
  return time > 0 ? (curve.values[to] - curve.values[from]) / time : 0;
}

void add_slopes(const Curve& of, Piece piece, Piece inner, Curve& slopes) {
  const auto reach = std::max<std::size_t>(1, inner.size() / parts_of_a_piece);
  for (auto i = piece.begin; i < piece.end; ++i) {
    const auto middle = std::clamp(i, inner.begin, inner.end - 1);
    const auto from = std::max(middle, inner.begin + reach) - reach;
    const auto to = std::min(middle + reach, inner.end - 1);
    slopes.times.push_back(of.times[i]);
    slopes.values.push_back(slope(of, from, to));
  }
}

}  // namespace

std::vector<double> all_times(const Curve& curve) {
  auto all = curve.times;
  for (const auto& other : curve.overlays)
    all.insert(all.end(), other.times.begin(), other.times.end());
  return all;
}

std::vector<double> all_values(const Curve& curve) {
  auto all = curve.values;
  for (const auto& other : curve.overlays)
    all.insert(all.end(), other.values.begin(), other.values.end());
  return all;
}

Curve derivative(const Curve& of, std::string name, std::string unit,
                 const std::vector<double>& breaks) {
  Curve slopes{std::move(name), std::move(unit), {}, {}};
  const auto count = of.times.size();
  std::size_t begin = 0;
  while (begin < count) {
    const auto next = std::ranges::upper_bound(breaks, of.times[begin]);
    const auto stop =
        next == breaks.end() ? of.times.end() : std::ranges::lower_bound(of.times, *next);
    const auto last = std::min(static_cast<std::size_t>(stop - of.times.begin()), count - 1);
    const Piece piece{begin, last + 1};
    add_slopes(of, piece, breaks.empty() ? piece : piece.inner(), slopes);
    begin = last + 1 < count ? last : count;
  }
  return slopes;
}

}  // namespace tmclctl::plot

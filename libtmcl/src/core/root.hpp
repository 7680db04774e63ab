/// Where a function of one number passes zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tmcl {

struct Point {
  double x;
  double y;
};

/// Where a function that grows from `low` to `high` passes zero, to the last bits: Chandrupatla's
/// method, which interpolates where that is safe and bisects otherwise.
template <class Function>
double root(Function f, Point low, Point high) {
  constexpr int most = 200;  // it takes less than ten; bisection alone never takes as many
  if (high.y <= 0) return high.x;
  if (low.y >= 0) return low.x;
  Point a = high, b = low, c = low;
  double step = a.y / (a.y - b.y);
  for (int round = 0; round < most; ++round) {
    const double x = a.x + step * (b.x - a.x);
    const Point next{x, f(x)};
    c = a;
    if ((next.y < 0) != (a.y < 0)) c = std::exchange(b, a);
    a = next;
    const double best = std::abs(a.y) < std::abs(b.y) ? a.x : b.x;
    const double width = std::abs(b.x - a.x);
    const double share = 2 * std::numeric_limits<double>::epsilon() * std::abs(best) / width;
    if (!(share < 0.5) || a.y == 0) return best;
    const double xi = (a.x - b.x) / (c.x - b.x);
    const double phi = (a.y - b.y) / (c.y - b.y);
    const bool interpolates = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    step = interpolates ? a.y / (b.y - a.y) * c.y / (b.y - c.y) +
                              (c.x - a.x) / (b.x - a.x) * a.y / (c.y - a.y) * b.y / (c.y - b.y)
                        : 0.5;
    step = std::clamp(step, share, 1 - share);
  }
  return a.x;
}

}  // namespace tmcl

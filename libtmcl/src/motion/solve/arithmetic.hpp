/// Arithmetic that several plans share.
#pragma once

#include <cmath>
#include <cstddef>

#include "tmcl/plan/path.hpp"

namespace tmcl::plan {

inline double square(double x) { return x * x; }

/// Also finite.
inline bool positive(double x) { return x > 0 && std::isfinite(x); }

/// Along a straight line, by the first so many axes.
inline double distance_between(const AxisValues& from, const AxisValues& to, std::size_t axes) {
  double length = 0;
  for (std::size_t axis = 0; axis < axes; ++axis)
    length = std::hypot(length, to[axis] - from[axis]);
  return length;
}

}  // namespace tmcl::plan

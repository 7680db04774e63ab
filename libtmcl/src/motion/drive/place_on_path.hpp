/// Where axes are beside a course and along it.
#pragma once

#include "tmcl/plan/course.hpp"

namespace tmcl::plan {

struct PlaceOnPath {
  double off = 0;    ///< From the nearest point of the course, in units.
  double lag_s = 0;  ///< How much later than planned they are there; negative: earlier.
};

/// The nearest point of the path is sought, which a shaped course leaves in corners: in what is
/// passed 0.1 s before and after `time`; within a second, if that is farther off than `known`.
PlaceOnPath place_on_path(const Course& course, double time, const AxisValues& place, double known);

}  // namespace tmcl::plan

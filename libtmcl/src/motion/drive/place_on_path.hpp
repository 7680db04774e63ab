/// Where axes are beside a course and along it.
#pragma once

#include <limits>
#include <vector>

#include "tmcl/plan/course.hpp"

namespace tmcl::plan {

struct PlaceOnPath {
  double off = 0;    ///< From the nearest point of the course, in units.
  double lag_s = 0;  ///< How much later than planned they are there; negative: earlier.
};

/// Finds the nearest points of one course, which must outlive it. The course is taken for chords of
/// 5 ms; their ends are kept, since one search follows another by less than that.
class PlaceFinder {
 public:
  explicit PlaceFinder(const Course& course);

  /// The nearest point of the path is sought, which a shaped course leaves in corners: in what is
  /// passed 0.1 s before and after `time`; within a second, if that is farther off than `known`.
  PlaceOnPath nearest(double time, const AxisValues& place, double known);

 private:
  struct ChordEnd {
    double number = std::numeric_limits<double>::quiet_NaN();  // none yet
    AxisValues position{};
  };

  PlaceOnPath nearest_within(double chords, double time, const AxisValues& place);
  const AxisValues& end_of_chord(double number);

  const Course& course_;
  std::vector<ChordEnd> kept_;
};

}  // namespace tmcl::plan

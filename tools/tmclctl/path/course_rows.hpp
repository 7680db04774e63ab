/// A course as rows for other programs: --csv.
#pragma once

#include <string>
#include <vector>

#include "output/errors.hpp"
#include "path/drawn_path.hpp"
#include "plot/shown.hpp"

namespace tmclctl::path {

/// Time, what is shown of each axis, and the distance from what the file draws, every so often
/// until the first row at which the axes stand at the end. Without anything shown it is all.
struct CourseRows {
  double step = 0;
  plot::Shown shown{};
};
Result<std::string> to_csv(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                           DrawnPath drawn, const CourseRows& rows);

}  // namespace tmclctl::path

/// A planned path in names and numbers.
#pragma once

#include <string>
#include <vector>

#include <boost/json/object.hpp>

#include "tmcl/api/path.hpp"
#include "tmcl/plan/course.hpp"

namespace tmcld {

using tmcl::api::path::most_curve_points;

/// `axes` are those of the file, in the order of the course.
boost::json::object to_json(const tmcl::plan::Course& course, const std::vector<std::string>& axes);
/// Where the axes are at so many times and at the end: enough to draw it.
boost::json::object curve_json(const tmcl::plan::Course& course, int points);

}  // namespace tmcld

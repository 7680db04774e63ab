/// The legs of a course in the parameters of ramp generators: when each speeds up and slows down,
/// and what each axis does meanwhile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <boost/json/array.hpp>

#include "output/screen.hpp"
#include "tmcl/plan/course.hpp"

namespace tmclctl::path {

/// A row for each leg: t1 where it begins, t2 where it has its speed, t3 where it slows down, t4
/// where it ends, and for each axis its target and ramp; with `microsteps_per_unit` in microsteps,
/// too.
boost::json::array leg_table(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                             std::optional<double> microsteps_per_unit);
void print_legs(const boost::json::array& legs, Output& output);

}  // namespace tmclctl::path

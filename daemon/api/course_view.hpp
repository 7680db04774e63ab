/// A planned path as clients see it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tmcl/api/path.hpp"
#include "tmcl/plan/course.hpp"

namespace tmcld {

/// Of so many axes.
std::vector<double> to_list(const tmcl::plan::AxisValues& values, std::size_t axes);
/// `axes` are those of the file, in the order of the course.
tmcl::api::path::Course view_of(const tmcl::plan::Course& course,
                                const std::vector<std::string>& axes);
/// What the shaping of a course makes of it; nothing without one.
std::optional<tmcl::api::path::Shaping> view_of(const tmcl::plan::Course& course,
                                                const std::optional<tmcl::plan::Shaping>& shaping,
                                                const std::vector<std::string>& names);
/// `unlimited` is the same without its jerk. `resonance`: of the loads that are told of.
tmcl::api::path::JerkLimit view_of_jerk(const tmcl::plan::Course& course,
                                        const tmcl::plan::Course& unlimited,
                                        const std::optional<tmcl::ramp::Resonance>& resonance,
                                        const std::vector<std::string>& names);
/// Where the axes are at so many times and at the end: enough to draw it.
tmcl::api::path::Curve curve_of(const tmcl::plan::Course& course, int points);

}  // namespace tmcld

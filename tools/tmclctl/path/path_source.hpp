/// A path file on its way to a course.
#pragma once

#include <limits>
#include <string>

#include "failure.hpp"
#include "screen.hpp"
#include "tmcl/plan/course.hpp"

namespace tmclctl::path {

/// What part of a tolerance chords may use up, and what part corners; the rest is for the axes.
constexpr double chords_part = 0.25;
constexpr double corners_part = 0.5;

struct Source {
  std::string file;
  bool gcode = false;
  tmcl::plan::path_file::Path path;  ///< Without arcs.
};

/// By its name (.csv; .ngc, .nc, .gcode, .gco, .tap), otherwise by its first line that says
/// something. What is wrong is printed as FILE:LINE:COLUMN: MESSAGE.
Attempt<Source> read_source(const std::string& file, double tolerance, Output& output);

/// `limits` without axes and tolerance of corners.
Attempt<tmcl::plan::Course> course_of(const Source& source, tmcl::plan::PathLimits limits,
                                      double tolerance,
                                      double feed = std::numeric_limits<double>::infinity());

/// Prints each problem, and says how many there are; also for programs in other languages.
Failure failure_from(const std::string& file, const tmcl::plan::TextProblems& problems,
                     Output& output);
/// The whole of a file of at most so many bytes.
Attempt<std::string> text_of(const std::string& file, std::size_t most_bytes);

/// The path as a drawing, x over y, above the positions of all axes over time.
std::string to_svg(const Source& source, const tmcl::plan::Course& course);

}  // namespace tmclctl::path

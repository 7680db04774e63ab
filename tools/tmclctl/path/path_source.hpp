/// A path file on its way to a course.
#pragma once

#include <string>

#include "failure.hpp"
#include "screen.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmclctl::path {

struct Source : tmcl::plan::PathSource {
  std::string file;
  std::string text;
};

/// What is wrong with the text is printed as FILE:LINE:COLUMN: MESSAGE.
Attempt<Source> read_source(const std::string& file, double tolerance, Output& output);

/// G-code begins there; for a table this does nothing.
Attempt<void> begin_where_axes_stand(Source& source, const std::vector<tmcl::plan::PathAxis>& axes,
                                     const tmcl::plan::PathRequest& request, Output& output);

/// `limits` without axes and tolerance of corners.
Attempt<tmcl::plan::Course> course_of(const Source& source, const tmcl::plan::PathLimits& limits,
                                      const tmcl::plan::PathRequest& request);

/// Without the name of a file.
Failure failure_from(const tmcl::plan::PathObjection& objection);
/// Prints each problem, and says how many there are; also for programs in other languages.
Failure failure_from(const std::string& file, const tmcl::plan::TextProblems& problems,
                     Output& output);
/// The whole of a file of at most so many bytes.
Attempt<std::string> text_of(const std::string& file, std::size_t most_bytes);

/// The path as a drawing, x over y, above the positions of all axes over time.
std::string to_svg(const Source& source, const tmcl::plan::Course& course);

}  // namespace tmclctl::path

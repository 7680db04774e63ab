/// What is said of a program of G-code: problems, and remarks about what is not carried out.
#pragma once

#include <cstddef>
#include <string>

#include "motion/path/gcode_block.hpp"
#include "motion/path/text_cursor.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {

class Report {
 public:
  Report(Unknowns unknowns, ProblemList& problems) : unknowns_(unknowns), problems_(problems) {}

  void begin_line(std::size_t number) { line_ = number; }
  /// A problem; a remark if it may be skipped, and what is not known is skipped.
  void complain(const Wrong& wrong);
  void complain(const Part<void>& part) {
    if (!part) complain(part.error());
  }
  void remark(std::size_t column, const std::string& message) {
    remarks_.add_once(line_, column, message);
  }
  /// Whether it is not known any more what the lines from here on would do.
  bool is_confused() const { return confused_; }
  bool skips_unknowns() const { return unknowns_ == Unknowns::skipped; }
  TextProblems take_remarks() { return remarks_.take(); }

 private:
  Unknowns unknowns_;
  ProblemList& problems_;
  ProblemList remarks_{most_remarks};
  std::string unknown_letters_;  ///< Each is named once.
  bool confused_ = false;
  std::size_t line_ = 0;
};

}  // namespace tmcl::plan::path_file::gcode

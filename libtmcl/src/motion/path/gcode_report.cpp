#include "motion/path/gcode_report.hpp"

namespace tmcl::plan::path_file::gcode {

void Report::complain(const Wrong& wrong) {
  const bool skipped = wrong.may_be_skipped && skips_unknowns();
  confused_ = confused_ || (wrong.confuses && !skipped);
  if (!wrong.unknown_letter.empty()) {
    const char letter = upper(wrong.unknown_letter.front());
    if (unknown_letters_.find(letter) != std::string::npos) return;
    unknown_letters_ += letter;
  }
  if (skipped) return remark(wrong.column, wrong.message + "; skipped");
  problems_.add_once(line_, wrong.column, wrong.message);
}

}  // namespace tmcl::plan::path_file::gcode

/// The codes of G-code that say where positions count from.
#pragma once

#include <map>
#include <optional>

#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_codes.hpp"
#include "motion/path/gcode_modes.hpp"
#include "motion/path/gcode_origins.hpp"
#include "motion/path/gcode_report.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file::gcode {

/// Lengths in mm, by their numbers, as in GcodeSetup; and the one that M6 has changed to.
struct Tools {
  const std::map<int, double>& lengths;
  std::optional<double> in_use{};
};

/// G54 to G59.
void select_system(const Codes& codes, Origins& origins, Report& report);
/// G10, where the axes are `at`.
Part<void> set_system(const Block& block, const Codes& codes, const Modes& modes, const Point& at,
                      Origins& origins);
/// G52 and G92.
Part<void> shift(const Block& block, const Codes& codes, const Modes& modes, const Point& at,
                 Origins& origins);
/// G43, G43.1 and G49.
Part<void> set_tool_length(const Block& block, const Codes& codes, const Modes& modes,
                           const Tools& tools, Origins& origins);

}  // namespace tmcl::plan::path_file::gcode

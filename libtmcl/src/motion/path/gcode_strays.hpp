/// Words of G-code that belong to a code which their line has not.
#pragma once

#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_codes.hpp"
#include "motion/path/gcode_modes.hpp"

namespace tmcl::plan::path_file::gcode {

/// `modes`: those that hold on the line itself. The first that is wrong.
Part<void> find_stray(const Block& block, const Codes& codes, const Modes& modes);

}  // namespace tmcl::plan::path_file::gcode

/// What became of axes that were moved together, in words with their names.
#pragma once

#include <string>
#include <vector>

#include "tmcl/plan/drive.hpp"

namespace tmcl {

/// One line without a full stop: "x is moving", "x: no reply".
std::string text_of(const plan::DriveFault& fault, const std::vector<std::string>& axes);
/// Sentences without a full stop: of axes that could not be stopped, of settings that could not be
/// set back, and of what could not be switched off.
std::vector<std::string> remarks_of(const plan::DriveReport& report,
                                    const std::vector<std::string>& axes);

}  // namespace tmcl

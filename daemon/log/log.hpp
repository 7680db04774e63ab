/// The daemon's log: lines on standard error. Hides the logging library, which is slow to compile.
#pragma once

#include <string_view>

#include "log/sink.hpp"

namespace tmcld {

/// Call once, before the first line.
void start_log(LogLevel level);
/// Takes the place of start_log() where nothing shall be written, as in tests.
void silence_log();

void log(LogLevel level, std::string_view line);

}  // namespace tmcld

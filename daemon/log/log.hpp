/// The daemon's log: lines on standard error. Callers never wait for the writing: a bounded number
/// of them waits, the oldest are left out then, and how many is told later. Hides the logging
/// library, which is slow to compile.
#pragma once

#include <string_view>

#include "log/sink.hpp"

namespace tmcld {

/// Call once, before the first line.
void start_log(LogLevel level);
/// Call once, after the last line: waits a moment until all are written. False if they could not
/// be, because no reader takes them; then the process can only end by std::_Exit().
bool end_log();
/// Takes the place of start_log() where nothing shall be written, as in tests.
void silence_log();

void log(LogLevel level, std::string_view line);
/// For lines that are work to write.
bool is_logged(LogLevel level);

}  // namespace tmcld

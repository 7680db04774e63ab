/// The daemon's log: lines on standard error. Hides the logging library, which is slow to compile.
#pragma once

#include <exception>
#include <string_view>

#include "config/config.hpp"

namespace tmcld {

/// Call once, before the first line.
void start_log(LogLevel level);
/// Takes the place of start_log() where nothing shall be written, as in tests.
void silence_log();

void log(LogLevel level, std::string_view line);

/// What an exception says; valid as long as the exception is.
const char* what_of(const std::exception_ptr& failure) noexcept;
/// An error line about it. Throws nothing: memory may be what is missing.
void log_failure(std::string_view where, const std::exception_ptr& failure) noexcept;

}  // namespace tmcld

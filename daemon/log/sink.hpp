/// Where the gateway's lines about what happens go; the maker of the gateway decides that.
#pragma once

#include <exception>
#include <functional>
#include <string_view>

#include "config/config.hpp"

namespace tmcld {

using LogSink = std::function<void(LogLevel level, std::string_view line)>;

/// For a gateway whose lines are dropped.
inline void no_log(LogLevel, std::string_view) {}

/// What an exception says; valid as long as the exception is.
const char* what_of(const std::exception_ptr& failure) noexcept;
/// An error line about it. Throws nothing: memory may be what is missing.
void log_failure(const LogSink& log, std::string_view where,
                 const std::exception_ptr& failure) noexcept;

}  // namespace tmcld

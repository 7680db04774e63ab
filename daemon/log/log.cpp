#include "log/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace tmcld {
namespace {

spdlog::level::level_enum to_spdlog(LogLevel level) {
  switch (level) {
    case LogLevel::error: return spdlog::level::err;
    case LogLevel::warning: return spdlog::level::warn;
    case LogLevel::info: return spdlog::level::info;
    case LogLevel::debug: return spdlog::level::debug;
  }
  return spdlog::level::info;
}

}  // namespace

void start_log(LogLevel level) {
  // One thread writes, apart from the library itself: no lock is needed.
  auto logger = spdlog::stderr_color_st("tmcld");
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  logger->set_level(to_spdlog(level));
  spdlog::set_default_logger(std::move(logger));
}

void silence_log() { spdlog::set_level(spdlog::level::off); }

void log(LogLevel level, std::string_view line) { spdlog::log(to_spdlog(level), "{}", line); }

}  // namespace tmcld

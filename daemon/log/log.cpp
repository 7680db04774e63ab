#include "log/log.hpp"

#include <sys/stat.h>
#include <syslog.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "async/ordinary_priority.hpp"
#include "log/journald.hpp"

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

/// By syslog's numbers.
int priority_of(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return LOG_ERR;
  if (level == spdlog::level::warn) return LOG_WARNING;
  return level == spdlog::level::info ? LOG_INFO : LOG_DEBUG;
}

/// The level as journald reads it at the beginning of a line.
class JournaldLevel final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& into) override {
    const auto level = '<' + std::to_string(priority_of(message.level)) + '>';
    into.append(level.data(), level.data() + level.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JournaldLevel>();
  }
};

/// What journald does not take goes to standard error.
class JournaldSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view line(message.payload.data(), message.payload.size());
    if (socket_.is_there() && socket_.send(journald_entry(priority_of(message.level), line)))
      return;
    spdlog::memory_buf_t text;
    formatter_->format(message, text);
    std::fwrite(text.data(), 1, text.size(), stderr);
  }
  void flush_() override {}

  JournaldSocket socket_;
};

struct stat standard_error() {
  struct stat behind {};
  ::fstat(STDERR_FILENO, &behind);
  return behind;
}

/// Whether standard error goes to journald, which sets this variable and keeps the time by itself.
bool is_journald() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  const auto behind = standard_error();
  return stream != nullptr &&
         stream == std::to_string(behind.st_dev) + ':' + std::to_string(behind.st_ino);
}

/// Straight to it, and not through something that only passes lines on.
bool is_journald_itself() { return is_journald() && S_ISSOCK(standard_error().st_mode); }

std::unique_ptr<spdlog::formatter> form_of_lines() {
  auto form = std::make_unique<spdlog::pattern_formatter>();
  form->add_flag<JournaldLevel>('*');
  form->set_pattern(is_journald() ? "%*%v" : "%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  return form;
}

// As many as an ending daemon writes, many times over; then the oldest are left out.
constexpr std::size_t most_waiting_lines = 1024;
constexpr tmcl::Duration time_for_log = std::chrono::milliseconds(300);

void note_left_out() {
  const auto pool = spdlog::thread_pool();
  static std::atomic<std::size_t> told = 0;
  if (!pool || pool->overrun_counter() == told || pool->queue_size() > 0) return;
  const auto all = pool->overrun_counter();
  const auto left_out = all - told.exchange(all);
  if (left_out > 0) spdlog::warn("{} lines were left out: they were not read in time", left_out);
}

}  // namespace

// A thread of its own writes: a reader of standard error that stalls blocks only that one.
void start_log(LogLevel level) {
  spdlog::init_thread_pool(most_waiting_lines, 1, take_ordinary_priority);
  auto logger = is_journald_itself()
                    ? spdlog::create_async_nb<JournaldSink>("tmcld")
                    : spdlog::create_async_nb<spdlog::sinks::stderr_color_sink_mt>("tmcld");
  logger->set_formatter(form_of_lines());
  logger->set_level(to_spdlog(level));
  spdlog::set_default_logger(std::move(logger));
}

bool end_log() {
  struct Written {
    std::mutex mutex;
    std::condition_variable changed;
    bool all = false;
  };
  const auto written = std::make_shared<Written>();
  // Waits for ever without a reader.
  std::thread([written] {
    spdlog::shutdown();
    const std::lock_guard lock(written->mutex);
    written->all = true;
    written->changed.notify_one();
  }).detach();
  std::unique_lock lock(written->mutex);
  return written->changed.wait_for(lock, time_for_log, [&] { return written->all; });
}

void silence_log() { spdlog::set_level(spdlog::level::off); }

bool is_logged(LogLevel level) { return spdlog::should_log(to_spdlog(level)); }

void log(LogLevel level, std::string_view line) {
  note_left_out();
  spdlog::log(to_spdlog(level), "{}", line);
}

}  // namespace tmcld

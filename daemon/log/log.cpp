#include "log/log.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <spdlog/async.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "async/ordinary_priority.hpp"

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

/// The level as journald reads it at the beginning of a line: by syslog's numbers.
class JournalLevel final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& into) override {
    const auto level = number_of(message.level);
    into.append(level.data(), level.data() + level.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<JournalLevel>();
  }

 private:
  static std::string_view number_of(spdlog::level::level_enum level) {
    if (level >= spdlog::level::err) return "<3>";
    if (level == spdlog::level::warn) return "<4>";
    return level == spdlog::level::info ? "<6>" : "<7>";
  }
};

/// Whether standard error goes to journald, which sets this variable and keeps the time by itself.
bool is_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat behind {};
  if (stream == nullptr || ::fstat(STDERR_FILENO, &behind) != 0) return false;
  return stream == std::to_string(behind.st_dev) + ':' + std::to_string(behind.st_ino);
}

std::unique_ptr<spdlog::formatter> form_of_lines() {
  auto form = std::make_unique<spdlog::pattern_formatter>();
  form->add_flag<JournalLevel>('*');
  form->set_pattern(is_journal() ? "%*%v" : "%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
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
  if (left_out > 0) spdlog::warn("{} lines were left out: nobody read them in time", left_out);
}

}  // namespace

// A thread of its own writes: whoever does not read standard error keeps nobody but that one.
void start_log(LogLevel level) {
  spdlog::init_thread_pool(most_waiting_lines, 1, take_ordinary_priority);
  auto logger = spdlog::create_async_nb<spdlog::sinks::stderr_color_sink_mt>("tmcld");
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
  // Waits for ever if nobody reads.
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

void log(LogLevel level, std::string_view line) {
  note_left_out();
  spdlog::log(to_spdlog(level), "{}", line);
}

}  // namespace tmcld

#include "log/audit_trail.hpp"

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "async/ordinary_priority.hpp"
#include "log/log.hpp"
#include "tmcl/utc_text.hpp"

namespace tmcld {
namespace {

constexpr mode_t for_owner_and_readers = 0640;
constexpr auto time_for_last_lines = std::chrono::milliseconds(300);
constexpr std::size_t entry_of_user_bytes = 16384;  // more than any account has

tl::expected<int, std::string> open_file(const std::string& path) {
  constexpr int flags = O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const int descriptor = ::open(path.c_str(), flags, for_owner_and_readers);
  if (descriptor < 0)
    return tl::unexpected("the audit file " + path + " cannot be opened: " + std::strerror(errno) +
                          "; it must be no symbolic link, in a directory that exists");
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) return descriptor;
  ::close(descriptor);
  return tl::unexpected("the audit file " + path + " is no file");
}

/// Asking may take a while where accounts are not on this computer.
std::string name_of_user(std::uint32_t uid) {
  std::vector<char> buffer(entry_of_user_bytes);
  passwd entry{};
  passwd* found = nullptr;
  ::getpwuid_r(uid, &entry, buffer.data(), buffer.size(), &found);
  return found == nullptr ? "" : found->pw_name;
}

}  // namespace

struct AuditTrail::Shared {
  struct Line {
    tmcl::UtcTime when;
    AuditEntry entry;
  };

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Line> waiting;
  std::size_t left_out = 0;
  bool must_reopen = false;
  bool ending = false;
  bool ended = false;

  // Of the thread alone.
  std::string path;
  int descriptor = -1;
  bool is_told = false;  // that the file takes nothing
  std::map<std::uint32_t, std::string> names;

  ~Shared() { close(); }
  void close() {
    if (descriptor >= 0) ::close(std::exchange(descriptor, -1));
  }

  void reopen() {
    if (path.empty()) return;
    close();
    const auto opened = open_file(path);
    if (opened) descriptor = *opened;
    if (!opened) log(LogLevel::error, opened.error());
  }

  std::string user(std::uint32_t uid) {
    const auto [known, is_new] = names.try_emplace(uid);
    if (is_new) known->second = name_of_user(uid);
    return known->second.empty() ? "" : " user=" + known->second;
  }

  void write(const Line& line) {
    const auto& [uid, pid, text] = line.entry;
    write(line.when, fmt::format("uid={}{} pid={} {}", uid, user(uid), pid, text));
  }

  void write(tmcl::UtcTime when, const std::string& text) {
    if (path.empty()) return log(LogLevel::info, "audit: " + text);
    const auto line = tmcl::to_text(when, 3) + " " + text + "\n";
    const auto written = ::write(descriptor, line.data(), line.size());
    const bool is_written = written == static_cast<ssize_t>(line.size());
    // Once, not for each line: the disk may stay full.
    if (!is_written && !std::exchange(is_told, true))
      log(LogLevel::error, "the audit file " + path + " takes nothing: " + std::strerror(errno));
    if (is_written) is_told = false;
  }
};

tl::expected<std::unique_ptr<AuditTrail>, std::string> AuditTrail::open(std::string file) {
  const auto shared = std::make_shared<Shared>();
  shared->path = std::move(file);
  if (!shared->path.empty()) {
    const auto opened = open_file(shared->path);
    if (!opened) return tl::unexpected(opened.error());
    shared->descriptor = *opened;
  }
  std::thread([shared] {
    take_ordinary_priority();
    write(shared);
  }).detach();
  return std::unique_ptr<AuditTrail>(new AuditTrail(shared));
}

AuditTrail::~AuditTrail() {
  std::unique_lock lock(shared_->mutex);
  shared_->ending = true;
  shared_->changed.notify_all();
  shared_->changed.wait_for(lock, time_for_last_lines, [&] { return shared_->ended; });
}

void AuditTrail::add(AuditEntry entry) {
  const auto when = tmcl::RealClock::utc();
  const std::lock_guard lock(shared_->mutex);
  if (shared_->waiting.size() < most_waiting_lines) {
    shared_->waiting.push_back({when, std::move(entry)});
  } else {
    ++shared_->left_out;
  }
  shared_->changed.notify_all();
}

void AuditTrail::reopen() {
  const std::lock_guard lock(shared_->mutex);
  shared_->must_reopen = true;
  shared_->changed.notify_all();
}

void AuditTrail::write(const std::shared_ptr<Shared>& shared) {
  auto& it = *shared;
  std::deque<Shared::Line> lines;
  std::unique_lock lock(it.mutex);
  while (true) {
    it.changed.wait(lock, [&] { return !it.waiting.empty() || it.must_reopen || it.ending; });
    lines.clear();
    std::swap(lines, it.waiting);
    const auto left_out = std::exchange(it.left_out, 0);
    const bool must_reopen = std::exchange(it.must_reopen, false);
    const bool is_last = it.ending;
    lock.unlock();
    std::size_t unwritten = 0;
    // Memory may be what is missing: nothing may come out of a thread.
    try {
      if (must_reopen) it.reopen();
      if (left_out > 0)
        it.write(tmcl::RealClock::utc(),
                 fmt::format("{} lines were left out: they came faster than they could be "
                             "written",
                             left_out));
    } catch (const std::exception&) {
      unwritten += left_out;
    }
    for (const auto& line : lines) {
      try {
        it.write(line);
      } catch (const std::exception&) {
        ++unwritten;
      }
    }
    lock.lock();
    it.left_out += unwritten;
    if (!is_last) continue;
    it.ended = true;
    it.changed.notify_all();
    return;
  }
}

}  // namespace tmcld

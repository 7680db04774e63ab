#include "log/audit_trail.hpp"

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <filesystem>
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

std::string cannot_be_opened(const std::string& path) {
  return "the audit file " + path + " cannot be opened: " + std::strerror(errno) +
         "; it must be no symbolic link, in a directory that exists";
}

tl::expected<int, std::string> open_file(const std::string& path, int creating = O_CREAT) {
  constexpr int flags = O_WRONLY | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  const int descriptor = ::open(path.c_str(), flags | creating, for_owner_and_readers);
  if (descriptor < 0) return tl::unexpected(cannot_be_opened(path));
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
  std::size_t unwritten = 0;  // lines, since the file took one
  bool is_torn = false;       // the last line in the file has no end
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
    struct stat status {};
    if (opened && ::fstat(descriptor, &status) == 0) is_torn = is_torn && status.st_size > 0;
    if (!opened) log(LogLevel::error, opened.error());
  }

  std::string user(std::uint32_t uid) {
    const auto [known, is_new] = names.try_emplace(uid);
    if (is_new) known->second = name_of_user(uid);
    return known->second.empty() ? "" : " user=" + known->second;
  }

  void write(const Line& line) {
    const auto& [uid, pid, text] = line.entry;
    // No process of this computer.
    if (pid == 0 && text.starts_with("client=")) return write(line.when, text);
    write(line.when, fmt::format("uid={}{} pid={} {}", uid, user(uid), pid, text));
  }

  /// `lines`: for how many this one stands.
  void write(tmcl::UtcTime when, const std::string& text, std::size_t lines = 1) {
    if (path.empty()) return log(LogLevel::info, "audit: " + text);
    if (unwritten > 0) tell_of_gap();
    if (unwritten > 0 || !append(line_of(when, text))) unwritten += lines;
  }

  void end() {
    if (unwritten > 0) tell_of_gap();
    if (unwritten > 0)
      log(LogLevel::error,
          fmt::format("{} lines are missing in the audit file {}", unwritten, path));
  }

  /// In the file, before anything else, as soon as it takes something again; and in the log.
  void tell_of_gap() {
    const auto words = fmt::format("{} lines were lost: the file took nothing", unwritten);
    if (!append(line_of(tmcl::RealClock::utc(), words))) return;
    log(LogLevel::warning, "the audit file " + path + " takes lines again; " + words);
    unwritten = 0;
  }

  static std::string line_of(tmcl::UtcTime when, const std::string& text) {
    return tmcl::to_text(when, 3) + " " + text + "\n";
  }

  /// All of it, or nothing.
  bool append(std::string line) {
    if (is_torn) line.insert(0, 1, '\n');
    std::size_t written = 0;
    while (written < line.size()) {
      const auto count = ::write(descriptor, line.data() + written, line.size() - written);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      written += static_cast<std::size_t>(count);
    }
    if (written == line.size()) {
      is_torn = false;
      return true;
    }
    const int why = errno;
    if (written > 0) take_back(written);
    // Once, not for each line: the disk may stay full.
    if (unwritten == 0) {
      log(LogLevel::error, "the audit file " + path + " takes nothing: " + std::strerror(why) +
                               "; lines are lost until it does");
    }
    return false;
  }

  /// So that no line has a part of another in front of it. A file that others shorten meanwhile, or
  /// that can only be added to, keeps the part, and the next line begins a new one.
  void take_back(std::size_t bytes) {
    struct stat status {};
    const bool is_known = ::fstat(descriptor, &status) == 0;
    const auto size = is_known ? static_cast<std::size_t>(status.st_size) : 0;
    is_torn = size < bytes || ::ftruncate(descriptor, static_cast<off_t>(size - bytes)) != 0;
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

std::string AuditTrail::problem_of(const std::string& file) {
  if (file.empty()) return {};
  struct stat status {};
  const auto folder = std::filesystem::path(file).parent_path();
  const bool is_missing = ::lstat(file.c_str(), &status) != 0 && errno == ENOENT;
  if (is_missing) {
    const auto* where = folder.empty() ? "." : folder.c_str();
    return ::access(where, W_OK | X_OK) == 0 ? "" : cannot_be_opened(file);
  }
  const auto opened = open_file(file, 0);
  if (!opened) return opened.error();
  ::close(*opened);
  return {};
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
    std::size_t failed = 0;
    // Memory may be what is missing: nothing may come out of a thread.
    try {
      if (must_reopen) it.reopen();
      if (left_out > 0)
        it.write(tmcl::RealClock::utc(),
                 fmt::format("{} lines were left out: they came faster than they could be "
                             "written",
                             left_out),
                 left_out);
    } catch (const std::exception&) {
      failed += left_out;
    }
    for (const auto& line : lines) {
      try {
        it.write(line);
      } catch (const std::exception&) {
        ++failed;
      }
    }
    lock.lock();
    it.left_out += failed;
    if (!is_last) continue;
    lock.unlock();
    try {
      it.end();
    } catch (const std::exception&) {  // memory is missing: nothing more can be told
    }
    lock.lock();
    it.ended = true;
    it.changed.notify_all();
    return;
  }
}

}  // namespace tmcld

#include "gateway/store/lock_file.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tmcld {
namespace {

constexpr int lock_tries = 3;
// A user who can open it can lock it, and so keep a daemon from starting.
constexpr mode_t access_to_lock = 0600;

bool is_same_file(int descriptor, const std::string& path) {
  struct stat here {};
  struct stat there {};
  return ::fstat(descriptor, &here) == 0 && ::lstat(path.c_str(), &there) == 0 &&
         here.st_ino == there.st_ino && here.st_dev == there.st_dev;
}

/// For people: the lock does not need it.
void write_holder(int descriptor) {
  const auto text = std::to_string(::getpid()) + "\n";
  if (::ftruncate(descriptor, 0) != 0) return;
  [[maybe_unused]] const auto written = ::pwrite(descriptor, text.data(), text.size(), 0);
}

}  // namespace

tl::expected<std::optional<LockFile>, std::string> LockFile::take(const std::string& path) {
  for (int i = 0; i < lock_tries; ++i) {
    const int descriptor =
        ::open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, access_to_lock);
    if (descriptor < 0) {
      return tl::unexpected("cannot create " + path + ": " + std::strerror(errno) +
                            "; may this user write to that directory?");
    }
    LockFile file(path, descriptor);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      file.path_.clear();
      return std::nullopt;
    }
    // The one who held it may have removed the file meanwhile; then the lock means nothing.
    if (is_same_file(descriptor, path)) {
      write_holder(descriptor);
      return file;
    }
    file.path_.clear();
  }
  return std::nullopt;
}

pid_t LockFile::holder(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  std::array<char, 16> text{};
  const auto size = ::pread(descriptor, text.data(), text.size() - 1, 0);
  if (descriptor >= 0) ::close(descriptor);
  return size > 0 ? static_cast<pid_t>(std::strtol(text.data(), nullptr, 10)) : 0;
}

LockFile::LockFile(LockFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

void LockFile::release() {
  if (descriptor_ < 0) return;
  if (!path_.empty()) ::unlink(path_.c_str());
  ::close(std::exchange(descriptor_, -1));
}

}  // namespace tmcld

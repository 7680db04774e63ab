/// A file that one process has at a time, until it ends, however that is.
#pragma once

#include <sys/types.h>
#include <string>

#include <tl/expected.hpp>

namespace tmcld {

/// Move-only. Of whichever path the file is reached by: the lock is on the file, not on its name.
class LockFile {
 public:
  struct Failure {
    bool is_held = false;  ///< By another process; otherwise the file cannot be made or opened.
    pid_t holder = 0;      ///< 0 if that is not known.
    std::string why{};     ///< In words, where it is not held.
  };

  static tl::expected<LockFile, Failure> take(std::string path);

  LockFile() = default;
  LockFile(LockFile&& other) noexcept;
  LockFile& operator=(LockFile&&) = delete;
  ~LockFile() { release(); }

  /// Removes the file. Nothing happens without one.
  void release();

 private:
  LockFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

  std::string path_;
  int descriptor_ = -1;
};

}  // namespace tmcld

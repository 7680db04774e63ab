/// A file that one process has at a time, until it ends, however that is.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace tmcld {

/// Move-only. Of whichever path the file is reached by: the lock is on the file, not on its name.
class LockFile {
 public:
  /// Nothing while another process has it. The error, in words: the file cannot be made or opened.
  static tl::expected<std::optional<LockFile>, std::string> take(const std::string& path);
  /// The process that has it, or had it last; 0 if that is not known.
  static pid_t holder(const std::string& path);

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

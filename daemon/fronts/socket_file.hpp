/// The unix socket in the file system: claimed by one daemon at a time, and gone when it ends; or
/// made by another process, which keeps it.
#pragma once

#include <sys/types.h>
#include <string>

#include <tl/expected.hpp>

#include "gateway/store/lock_file.hpp"

namespace tmcld {

/// Move-only. A lock on PATH.lock decides between two daemons that start at once.
class SocketFile {
 public:
  /// Errors: a sentence for a person, with what to try.
  static tl::expected<SocketFile, std::string> claim(const std::string& path);
  /// One that listens already, and is left where it is at the end. Takes the descriptor over.
  /// Errors: a sentence, if it is not the socket at `path`.
  static tl::expected<SocketFile, std::string> passed(int descriptor, const std::string& path);

  SocketFile(SocketFile&& other) noexcept;
  SocketFile& operator=(SocketFile&&) = delete;
  ~SocketFile();

  /// Listens; its taker closes it.
  int release_descriptor();
  /// Clients may have come before anybody served them.
  bool was_passed() const { return was_passed_; }
  /// Removes the file, unless another program has put its own there.
  void remove();

 private:
  SocketFile(std::string path, LockFile lock) : path_(std::move(path)), lock_(std::move(lock)) {}
  std::string listen();

  std::string path_;
  LockFile lock_;
  int descriptor_ = -1;
  ino_t inode_ = 0;
  bool was_passed_ = false;
};

}  // namespace tmcld

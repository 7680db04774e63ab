/// The unix socket in the file system: claimed by one daemon at a time, and gone when it ends.
#pragma once

#include <sys/types.h>
#include <string>

#include <tl/expected.hpp>

namespace tmcld {

/// Move-only. A lock on PATH.lock decides between two daemons that start at once.
class SocketFile {
 public:
  /// Errors: a sentence for a person, with what to try.
  static tl::expected<SocketFile, std::string> claim(const std::string& path);

  SocketFile(SocketFile&& other) noexcept;
  SocketFile& operator=(SocketFile&&) = delete;
  ~SocketFile();

  /// Listens; whoever takes it over closes it.
  int release_descriptor();
  /// Removes the file, unless another program has put its own there.
  void remove();

 private:
  SocketFile(std::string path, int lock) : path_(std::move(path)), lock_(lock) {}
  std::string listen();

  std::string path_;
  int lock_ = -1;
  int descriptor_ = -1;
  ino_t inode_ = 0;
};

}  // namespace tmcld

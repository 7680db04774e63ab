/// Files of a test. Each program of tests has a folder for them, and removes it when it ends.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

#include <gtest/gtest.h>

namespace tmcl::test {

/// Other users may read it: some tests run a program as another user.
class TempFolder {
 public:
  TempFolder() {
    std::filesystem::remove_all(path_);
    std::filesystem::create_directory(path_);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;
  ~TempFolder() {
    std::error_code ignored;
    if (::getpid() == owner_) std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  const pid_t owner_ = ::getpid();  ///< A forked process does not remove it.
  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("tmcl_tests_" + std::to_string(owner_));
};

inline std::string temp_path(const std::string& name) {
  static const TempFolder folder;
  return folder.path() / name;
}

}  // namespace tmcl::test

/// A file of a test's own: tests run side by side, each in a process, with which its files go.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include <unistd.h>

#include <gtest/gtest.h>

namespace tmcl::test {

/// Others may look into it: some tests are other users.
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
  const pid_t owner_ = ::getpid();  ///< A forked process leaves it.
  const std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("tmcl_tests_" + std::to_string(owner_));
};

inline std::string temp_path(const std::string& name) {
  static const TempFolder folder;
  return folder.path() / name;
}

}  // namespace tmcl::test

/// A file of a test's own: tests run side by side, each in a process.
#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

#include <gtest/gtest.h>

namespace tmcl::test {

inline std::string temp_path(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / (std::to_string(::getpid()) + '_' + name);
}

}  // namespace tmcl::test

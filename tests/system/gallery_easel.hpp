/// Where the pictures of docs/gallery come from and go to.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "support/build_paths.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_picture = 60'000;

inline fs::path docs() { return fs::path(TMCL_SOURCE_DIR) / "docs"; }
inline fs::path gallery() { return docs() / "gallery"; }
inline std::string page() { return contents(gallery() / "README.md"); }
inline bool is_drawing() { return std::getenv("TMCL_DRAW") != nullptr; }

/// Where a scene leaves its pictures: in the gallery only if that was asked for.
class Easel {
 public:
  Easel() {
    std::string name = fs::temp_directory_path() / "gallery-XXXXXX";
    folder_ = ::mkdtemp(name.data());
  }
  ~Easel() { fs::remove_all(folder_); }
  Easel(const Easel&) = delete;
  Easel& operator=(const Easel&) = delete;

  std::string file(const std::string& name) const { return folder_ / name; }
  void hang(const std::string& picture) const {
    EXPECT_LT(fs::file_size(file(picture)), largest_picture) << picture;
    if (is_drawing() && !testing::Test::HasFailure())
      fs::copy_file(file(picture), gallery() / picture, fs::copy_options::overwrite_existing);
  }
  void hang(const std::string& picture, const std::string& svg) const {
    std::ofstream(file(picture)) << svg;
    hang(picture);
  }

 private:
  fs::path folder_;
};

inline double number(const boost::json::object& document, const char* key) {
  return document.at(key).to_number<double>();
}

}  // namespace tmcl::test

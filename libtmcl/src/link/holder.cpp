#include "link/holder.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

namespace tmcl {
namespace {

namespace fs = std::filesystem;

bool has_open(const fs::path& process, const fs::path& device) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(process / "fd", error)) {
    if (fs::read_symlink(entry.path(), error) == device) return true;
  }
  return false;
}

std::string name_of_process(const fs::path& process) {
  std::string name;
  std::ifstream file(process / "comm");
  std::getline(file, name);
  return name.empty() ? "a program" : name;
}

}  // namespace

std::string holder_of(const std::string& device) {
  std::error_code error;
  const auto target = fs::canonical(device, error);
  if (error) return {};
  for (const auto& process : fs::directory_iterator("/proc", error)) {
    const auto id = process.path().filename().string();
    const bool is_process =
        std::ranges::all_of(id, [](unsigned char c) { return std::isdigit(c) != 0; });
    if (!is_process || !has_open(process.path(), target)) continue;
    return name_of_process(process.path()) + " (process " + id + ")";
  }
  return {};
}

}  // namespace tmcl

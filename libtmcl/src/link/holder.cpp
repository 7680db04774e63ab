#include "link/holder.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "link/processes.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;

/// The holder of the kernel's lock on the file: "1: FLOCK ADVISORY WRITE 4711 00:1b:5 0 EOF".
std::optional<std::string> process_with_lock(const std::string& device) {
  struct stat status {};
  if (stat(device.c_str(), &status) != 0) return std::nullopt;
  const auto file =
      fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::ifstream locks("/proc/locks");
  std::string number, kind, manner, access, process, locked, first, last;
  while (locks >> number >> kind >> manner >> access >> process >> locked >> first >> last) {
    if (kind == "FLOCK" && locked == file) return process;
  }
  return std::nullopt;
}

bool has_open(const fs::path& process, const fs::path& device) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(process / "fd", error)) {
    if (fs::read_symlink(entry.path(), error) == device) return true;
  }
  return false;
}

/// For ports that a program uses without locking them.
std::optional<std::string> process_with_file(const std::string& device) {
  std::error_code error;
  const auto target = fs::canonical(device, error);
  if (error) return std::nullopt;
  for (const auto& process : all_processes())
    if (has_open("/proc/" + process, target)) return process;
  return std::nullopt;
}

}  // namespace

std::string this_process() { return describe_process(std::to_string(getpid())); }

std::string holder_of(const std::string& device) {
  auto process = process_with_lock(device);
  if (!process) process = process_with_file(device);
  return process ? describe_process(*process) : std::string{};
}

}  // namespace tmcl

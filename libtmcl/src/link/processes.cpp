#include "link/processes.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace tmcl {
namespace {

namespace fs = std::filesystem;

/// As /proc has it: "4711 (a name, with any signs) S 1 4711 4711 34829 ...". 0: it has none.
std::uint64_t controlling_terminal(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  std::string text;
  std::getline(file, text);
  const auto end_of_name = text.rfind(')');
  if (end_of_name == std::string::npos) return 0;
  std::istringstream rest(text.substr(end_of_name + 1));
  std::string state;
  long parent = 0, group = 0, session = 0;
  std::int64_t terminal = 0;
  rest >> state >> parent >> group >> session >> terminal;
  return rest ? static_cast<std::uint32_t>(terminal) : 0;
}

/// The low eight bits of the minor number, the major number, the other bits of the minor number.
std::uint64_t number_in_proc(std::uint64_t device) {
  const std::uint64_t low = minor(device) & 0xFFU;
  const std::uint64_t high = minor(device) & ~0xFFU;
  return low | std::uint64_t{major(device)} << 8 | high << 12;
}

bool is_pseudo_terminal(std::uint64_t device) {
  constexpr unsigned first_major = 136;
  constexpr unsigned last_major = 143;
  return major(device) >= first_major && major(device) <= last_major;
}

}  // namespace

std::vector<std::string> all_processes() {
  std::vector<std::string> all;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    auto id = entry.path().filename().string();
    const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
    if (std::ranges::all_of(id, is_digit)) all.push_back(std::move(id));
  }
  return all;
}

std::string describe_process(const std::string& id) {
  std::string name;
  std::ifstream file("/proc/" + id + "/comm");
  std::getline(file, name);
  return (name.empty() ? "a program" : name) + " (process " + id + ")";
}

std::string program_at_terminal(std::uint64_t device_number) {
  if (!is_pseudo_terminal(device_number)) return {};
  const auto terminal = number_in_proc(device_number);
  for (const auto& process : all_processes())
    if (controlling_terminal(process) == terminal) return describe_process(process);
  return {};
}

std::string program_at_terminal(const std::string& device) {
  struct stat status {};
  const bool is_there = stat(device.c_str(), &status) == 0 && S_ISCHR(status.st_mode);
  return is_there ? program_at_terminal(status.st_rdev) : std::string{};
}

}  // namespace tmcl

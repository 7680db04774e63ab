#include "port_checks.hpp"

#include <fstream>
#include <optional>
#include <system_error>

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <fmt/format.h>

#include "tmcl/ports.hpp"

namespace tmclctl {
namespace {

namespace fs = std::filesystem;
using tmcl::Check;

/// A byte waits for others in an adapter for no longer than this.
constexpr int fine_latency_ms = 2;

std::optional<std::string> first_line(const fs::path& path) {
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  return line;
}

class PortChecks {
 public:
  PortChecks(const std::string& device, const fs::path& root)
      : device_(device), root_(root), path_(in_root(device)) {
    std::error_code unknown;
    if (const auto real = fs::canonical(path_, unknown); !unknown) path_ = real;
  }

  bool exists() const {
    std::error_code unknown;
    return fs::exists(path_, unknown);
  }
  void note(Check check, bool wrong, std::string text) {
    findings_.push_back({check, device_, wrong, std::move(text)});
  }
  void look_at_access();
  void look_at_holder(std::string_view allowed);
  void look_at_modem_manager();
  void look_at_latency();
  std::vector<tmcl::Finding> take() { return std::move(findings_); }

 private:
  fs::path in_root(const std::string& path) const { return root_ / fs::path(path).relative_path(); }
  bool is_left_alone() const;
  bool runs(std::string_view program) const;

  std::string device_;
  fs::path root_;
  fs::path path_;
  std::vector<tmcl::Finding> findings_;
};

void PortChecks::look_at_access() {
  const bool may = ::access(path_.c_str(), R_OK | W_OK) == 0;
  note(Check::access, !may, may ? "it may" : "it may not: 'ls -l' shows whose it is");
}

void PortChecks::look_at_holder(std::string_view allowed) {
  tmcl::Port port;
  port.device = path_.string();
  const auto holder = holder_of(port);
  const bool is_allowed = !allowed.empty() && holder.starts_with(allowed);
  const bool is_this = holder.ends_with(fmt::format("(process {})", ::getpid()));
  note(Check::holder, !holder.empty() && !is_allowed,
       holder.empty() ? "none that is seen"
       : is_this      ? "it is: only this program has it"
                      : holder);
}

bool PortChecks::runs(std::string_view program) const {
  std::error_code unknown;
  for (const auto& entry : fs::directory_iterator(root_ / "proc", unknown))
    if (first_line(entry.path() / "comm") == program) return true;
  return false;
}

/// What udev says of it to ModemManager.
bool PortChecks::is_left_alone() const {
  struct stat status {};
  if (::stat(path_.c_str(), &status) != 0 || !S_ISCHR(status.st_mode)) return true;
  std::ifstream file(
      root_ / fmt::format("run/udev/data/c{}:{}", major(status.st_rdev), minor(status.st_rdev)));
  for (std::string line; std::getline(file, line);)
    if (line == "E:ID_MM_DEVICE_IGNORE=1" || line == "E:ID_MM_PORT_IGNORE=1") return true;
  return false;
}

void PortChecks::look_at_modem_manager() {
  const auto name = path_.filename().string();
  const bool is_candidate = name.starts_with("ttyACM") || name.starts_with("ttyUSB");
  const bool tries = is_candidate && runs("ModemManager") && !is_left_alone();
  note(Check::modem_manager, tries,
       tries ? "no udev rule keeps it away: it opens the port when it is plugged in" : "it does");
}

void PortChecks::look_at_latency() {
  const auto file = root_ / "sys/class/tty" / path_.filename() / "device/latency_timer";
  const auto line = first_line(file);
  if (!line) return;
  const int ms = std::atoi(line->c_str());
  note(Check::latency, ms > fine_latency_ms, fmt::format("for up to {} ms", ms));
}

}  // namespace

std::vector<tmcl::Finding> look_at_port(const std::string& device, std::string_view holder,
                                        const fs::path& root) {
  PortChecks checks(device, root);
  if (!checks.exists()) {
    checks.note(Check::port, true, "there is none of this name");
    return checks.take();
  }
  checks.note(Check::port, false, "there is");
  checks.look_at_access();
  checks.look_at_holder(holder);
  checks.look_at_modem_manager();
  checks.look_at_latency();
  return checks.take();
}

}  // namespace tmclctl

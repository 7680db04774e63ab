#include "output_file.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

namespace tmclctl {

Attempt<void> OutputFile::open(const std::string& path) {
  path_ = path;
  if (path.empty()) return {};
  file_.open(path, std::ios::binary | std::ios::trunc);
  if (!file_) return tl::unexpected(problem());
  return {};
}

Attempt<void> OutputFile::write(const std::string& text) {
  if (!file_.is_open()) return {};
  file_ << text;
  file_.close();
  if (file_) return {};
  // What was to be written has happened already.
  auto failure = problem();
  failure.exit = ExitCode::refused;
  failure.outcome = tmcl::Outcome::done;
  return tl::unexpected(std::move(failure));
}

Failure OutputFile::problem() const {
  return usage_failure("cannot_write",
                       fmt::format("cannot write {}: {}", path_, std::strerror(errno)));
}

}  // namespace tmclctl

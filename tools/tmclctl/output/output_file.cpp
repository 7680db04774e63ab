#include "output_file.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace tmclctl {

Result<void> OutputFile::open(const std::string& path) {
  path_ = path;
  if (path.empty()) return {};
  if (path == "-")
    return tl::unexpected(
        usage_error("cannot_write", "'-' names no file here", "/dev/stdout is standard output"));
  file_.open(path, std::ios::binary | std::ios::trunc);
  if (!file_) return tl::unexpected(problem());
  return {};
}

Result<void> OutputFile::open_behind(const std::string& path, std::size_t bytes) {
  path_ = path;
  std::error_code failed;
  std::filesystem::resize_file(path, bytes, failed);
  if (!failed) file_.open(path, std::ios::binary | std::ios::app);
  if (failed) errno = failed.value();
  if (!file_.is_open()) return tl::unexpected(problem());
  return {};
}

Result<void> OutputFile::write(const std::string& text) {
  auto written = append(text);
  file_.close();
  return written;
}

Result<void> OutputFile::append(const std::string& text) {
  if (!file_.is_open()) return {};
  file_ << text << std::flush;
  if (file_) return {};
  // What was to be written has happened already.
  auto failure = problem();
  failure.kind = ErrorKind::not_now;
  failure.outcome = tmcl::Outcome::done;
  return tl::unexpected(std::move(failure));
}

Error OutputFile::problem() const {
  return usage_error("cannot_write",
                     fmt::format("cannot write {}: {}", path_, std::strerror(errno)));
}

}  // namespace tmclctl

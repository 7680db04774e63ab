#include "tmcl/link_file.hpp"

#include <system_error>

#include "link/processes.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;

// Nothing if `path` is free, or was a leftover and now is.
std::string refusal(const fs::path& path, const fs::path& target) {
  std::error_code error;
  const auto found = fs::symlink_status(path, error);
  if (found.type() == fs::file_type::not_found) return {};
  if (found.type() == fs::file_type::none) return path.string() + ": " + error.message();
  if (found.type() != fs::file_type::symlink) {
    return "there is " + std::string(fs::is_directory(found) ? "a folder" : "a file") + " at " +
           path.string() + ", where the link is to be; give another path";
  }
  const auto leads_to = fs::read_symlink(path, error);
  // A terminal of that number is another program's by now: the one that made the link is gone.
  const bool is_stale = !fs::exists(path, error) || !program_at_terminal(path.string()).empty();
  if (!is_stale && leads_to != target) {
    return path.string() + " already leads to " + leads_to.string() +
           ", which is in use. Does another program serve it? If not, remove it: rm " +
           path.string();
  }
  fs::remove(path, error);
  return error ? "cannot replace " + path.string() + ": " + error.message() : std::string{};
}

}  // namespace

tl::expected<LinkFile, std::string> LinkFile::create(const fs::path& path, const fs::path& target) {
  std::error_code error;
  const auto folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return tl::unexpected("there is no folder " + folder.string() +
                          " for the link; create it first: mkdir -p " + folder.string());
  }
  if (auto reason = refusal(path, target); !reason.empty()) return tl::unexpected(reason);
  fs::create_symlink(target, path, error);
  if (error) return tl::unexpected("cannot create " + path.string() + ": " + error.message());
  return LinkFile(path, target);
}

LinkFile::~LinkFile() {
  if (path_.empty()) return;
  std::error_code error;
  if (fs::read_symlink(path_, error) == target_ && !error) fs::remove(path_, error);
}

}  // namespace tmcl

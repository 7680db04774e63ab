#include "config/files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace tmcld {
namespace {

// A configuration of max_axes axes has some 20 kB; a whole disk given by mistake has more.
constexpr std::size_t max_file_bytes = 1U << 20U;

tmcl::TextProblem problem_of(const std::string& path, std::string message) {
  return {.message = std::move(message), .file = path};
}

tmcl::TextProblem cannot_be_read(const std::string& path, int error) {
  return problem_of(path, std::string("cannot be read: ") + std::strerror(error));
}

/// Who writes the configuration decides where motors may go.
std::optional<tmcl::TextProblem> objection_to_writers(const std::string& path,
                                                      const struct stat& status, uid_t writer) {
  const bool is_ours =
      status.st_uid == 0 || status.st_uid == ::geteuid() || status.st_uid == writer;
  if (!is_ours) {
    return problem_of(path, "belongs to another user (uid " + std::to_string(status.st_uid) +
                                "), who could change limits of axes; make it root's or your own: "
                                "`chown`");
  }
  const bool open = (status.st_mode & S_IWOTH) != 0;
  if (open && S_ISDIR(status.st_mode)) {
    return problem_of(path,
                      "everybody may write to it, and so change limits of axes; keep the "
                      "configuration in a folder where only root or you may write");
  }
  if (open && S_ISREG(status.st_mode)) {
    return problem_of(
        path,
        "everybody may write to it, and so change limits of axes; try `chmod o-w " + path + "`");
  }
  return std::nullopt;
}

/// `writer`: who may write it besides root and this user.
tl::expected<ConfigFile, tmcl::TextProblem> read_file(const std::string& path, uid_t writer = 0) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"),
                                                             &std::fclose);
  struct stat status {};
  if (!file || ::fstat(::fileno(file.get()), &status) != 0)
    return tl::unexpected(cannot_be_read(path, errno));
  if (S_ISDIR(status.st_mode)) {
    return tl::unexpected(
        problem_of(path, "is a folder; a configuration is a file, such as /etc/tmcl/tmcld.toml"));
  }
  if (auto objection = objection_to_writers(path, status, writer))
    return tl::unexpected(*objection);
  std::string text(max_file_bytes + 1, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (std::ferror(file.get()) != 0) return tl::unexpected(cannot_be_read(path, errno));
  if (text.size() > max_file_bytes) return tl::unexpected(problem_of(path, "is larger than 1 MiB"));
  return ConfigFile{path, std::move(text)};
}

/// Editors and package managers leave files with other names there.
bool is_drop_in(const std::filesystem::path& path) {
  return path.extension() == ".toml" && !path.filename().string().starts_with('.');
}

/// Their paths, in order.
tl::expected<std::vector<std::string>, tmcl::TextProblem> drop_ins_beside(const std::string& path) {
  const auto folder = std::filesystem::path(path).replace_extension(".d");
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) return std::vector<std::string>{};
    return tl::unexpected(cannot_be_read(folder, errno));
  }
  if (!S_ISDIR(status.st_mode)) return std::vector<std::string>{};
  if (auto objection = objection_to_writers(folder, status, 0)) return tl::unexpected(*objection);
  std::vector<std::string> paths;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; entry != end && !error;
       entry.increment(error)) {
    if (is_drop_in(entry->path())) paths.push_back(entry->path());
  }
  if (error) return tl::unexpected(cannot_be_read(folder, error.value()));
  if (paths.size() > max_drop_ins) {
    return tl::unexpected(problem_of(folder, "has more than " + std::to_string(max_drop_ins) +
                                                 " files; put several sections into one"));
  }
  std::ranges::sort(paths);
  return paths;
}

}  // namespace

tl::expected<std::vector<ConfigFile>, tmcl::TextProblem> read_config_files(
    const std::string& path) {
  auto named = read_file(path);
  if (!named) return tl::unexpected(std::move(named.error()));
  const auto drop_ins = drop_ins_beside(path);
  if (!drop_ins) return tl::unexpected(drop_ins.error());
  std::vector<ConfigFile> files{std::move(*named)};
  for (const auto& one : *drop_ins) {
    auto file = read_file(one);
    if (!file) return tl::unexpected(std::move(file.error()));
    files.push_back(std::move(*file));
  }
  return files;
}

tl::expected<std::optional<ConfigFile>, tmcl::TextProblem> read_managed_file(
    const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return std::nullopt;
    return tl::unexpected(cannot_be_read(path, errno));
  }
  // Who has the folder could put another file there.
  const auto folder = std::filesystem::path(path).parent_path();
  if (::stat(folder.c_str(), &status) != 0) return tl::unexpected(cannot_be_read(folder, errno));
  return read_file(path, status.st_uid).map([](ConfigFile file) {
    return std::optional(std::move(file));
  });
}

}  // namespace tmcld

#include "gateway/store/state_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tmcld {
namespace {

constexpr std::size_t most_bytes = 1 << 20;
constexpr mode_t access_for_owner = 0600;
constexpr mode_t access_to_configuration = 0640;

struct Descriptor {
  int number;
  ~Descriptor() { ::close(number); }
};

std::string because() { return std::string(": ") + std::strerror(errno); }

std::string beside(const std::string& path) { return path + ".new"; }

bool write_whole(int file, std::string_view text) {
  while (!text.empty()) {
    const auto size = ::write(file, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  return true;
}

/// Empty if all went well.
std::string sync_folder_of(const std::string& path) {
  const auto folder = path.substr(0, path.rfind('/') + 1);
  const Descriptor file{
      ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  return file.number >= 0 && ::fsync(file.number) == 0 ? "" : "cannot keep " + path + because();
}

}  // namespace

tl::expected<std::optional<std::string>, std::string> read_state_file(const std::string& path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC)};
  if (file.number < 0 && errno == ENOENT) return std::nullopt;
  if (file.number < 0) return tl::unexpected("cannot open " + path + because());
  // It moves and sets axes: no other user may write it.
  struct stat status {};
  const bool is_own = ::fstat(file.number, &status) == 0 && status.st_uid == ::geteuid() &&
                      (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
  if (!is_own) return tl::unexpected(path + " can be written by other users");
  std::string text(most_bytes, '\0');
  const auto size = ::read(file.number, text.data(), text.size());
  if (size < 0) return tl::unexpected("cannot read " + path + because());
  text.resize(static_cast<std::size_t>(size));
  return text;
}

std::string replace_state_file(const std::string& path, const std::string& text) {
  const auto next = beside(path);
  {
    const Descriptor file{::open(
        next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, access_for_owner)};
    if (file.number < 0) return "cannot create " + next + because();
    if (!write_whole(file.number, text)) return "cannot write " + next + because();
  }
  if (std::rename(next.c_str(), path.c_str()) != 0) return "cannot replace " + path + because();
  return {};
}

std::string remove_state_file(const std::string& path) {
  return ::unlink(path.c_str()) == 0 || errno == ENOENT ? "" : "cannot remove " + path + because();
}

tl::expected<StagedFile, std::string> StagedFile::write(std::string path, std::string_view text) {
  const auto next = beside(path);
  const Descriptor file{::open(next.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC,
                               access_to_configuration)};
  if (file.number < 0) return tl::unexpected("cannot create " + next + because());
  StagedFile staged(std::move(path));
  if (write_whole(file.number, text) && ::fsync(file.number) == 0) return staged;
  return tl::unexpected("cannot write " + next + because());
}

std::string StagedFile::put_in_place() {
  if (std::rename(beside(path_).c_str(), path_.c_str()) != 0)
    return "cannot replace " + path_ + because();
  return sync_folder_of(std::exchange(path_, {}));
}

StagedFile::~StagedFile() {
  if (!path_.empty()) ::unlink(beside(path_).c_str());
}

}  // namespace tmcld

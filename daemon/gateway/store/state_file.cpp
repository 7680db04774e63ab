#include "gateway/store/state_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tmcld {
namespace {

constexpr std::size_t most_bytes = 1 << 20;
constexpr mode_t access_for_owner = 0600;

struct Descriptor {
  int number;
  ~Descriptor() { ::close(number); }
};

std::string because() { return std::string(": ") + std::strerror(errno); }

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
  const auto beside = path + ".new";
  {
    const Descriptor file{::open(
        beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, access_for_owner)};
    if (file.number < 0) return "cannot create " + beside + because();
    if (::write(file.number, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      return "cannot write " + beside + because();
  }
  if (std::rename(beside.c_str(), path.c_str()) != 0) return "cannot replace " + path + because();
  return {};
}

std::string remove_state_file(const std::string& path) {
  return ::unlink(path.c_str()) == 0 || errno == ENOENT ? "" : "cannot remove " + path + because();
}

}  // namespace tmcld

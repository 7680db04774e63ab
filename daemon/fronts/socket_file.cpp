#include "fronts/socket_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace tmcld {
namespace {

constexpr int waiting_connections = 128;
constexpr mode_t access_for_owner_and_group = 0660;

std::string because(int error) { return std::string(": ") + std::strerror(error); }

std::string in_use(const std::string& path, pid_t by = 0) {
  const auto process = by > 0 ? " (process " + std::to_string(by) + ")" : std::string();
  return "another daemon already serves " + path + process +
         "; end it first, or choose another 'socket' in the configuration";
}

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // The configuration has checked that it fits.
  std::copy_n(path.data(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  return address;
}

const sockaddr* generic(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

std::optional<std::string> check_directory(const std::string& path) {
  auto directory = std::filesystem::path(path).parent_path();
  if (directory.empty()) directory = ".";
  std::error_code error;
  if (std::filesystem::is_directory(directory, error)) return std::nullopt;
  return "the directory " + directory.string() + " for the socket does not exist; create it (" +
         "`install -d " + directory.string() + "`) or choose another 'socket' in the configuration";
}

ino_t inode_of(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

std::string path_of(int descriptor) {
  sockaddr_un address{};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return {};
  return {address.sun_path, ::strnlen(address.sun_path, sizeof address.sun_path)};
}

/// Nothing if the path is free now.
std::optional<std::string> clear_away(const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return std::nullopt;
    return "cannot look at " + path + because(errno);
  }
  if (!S_ISSOCK(status.st_mode)) return path + " exists and is no socket; it is left alone";
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto address = address_of(path);
  const int result = ::connect(probe, generic(address), sizeof address);
  const int error = errno;
  ::close(probe);
  if (result == 0 || error == EAGAIN) return in_use(path);
  if (error != ECONNREFUSED) return "cannot find out who serves " + path + because(error);
  if (::unlink(path.c_str()) == 0) return std::nullopt;
  return "cannot remove the stale socket " + path + because(errno);
}

}  // namespace

tl::expected<SocketFile, std::string> SocketFile::claim(const std::string& path) {
  if (auto problem = check_directory(path)) return tl::unexpected(std::move(*problem));
  const auto lock_path = path + ".lock";
  auto lock = LockFile::take(lock_path);
  if (!lock) return tl::unexpected(std::move(lock.error()));
  if (!*lock) return tl::unexpected(in_use(path, LockFile::holder(lock_path)));
  SocketFile file(path, std::move(**lock));
  if (auto problem = clear_away(path)) return tl::unexpected(std::move(*problem));
  auto problem = file.listen();
  if (!problem.empty()) return tl::unexpected(std::move(problem));
  return file;
}

tl::expected<SocketFile, std::string> SocketFile::passed(int descriptor, const std::string& path) {
  SocketFile file(path, LockFile());
  file.descriptor_ = descriptor;
  file.was_passed_ = true;
  const auto its_path = path_of(descriptor);
  std::error_code error;
  if (its_path == path || std::filesystem::equivalent(its_path, path, error)) return file;
  return tl::unexpected("the socket that tmcld was passed is at " + its_path +
                        ", but clients look for it at " + path +
                        ": let 'socket' in [daemon] and ListenStream= of the socket's unit name "
                        "the same path");
}

std::string SocketFile::listen() {
  descriptor_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto address = address_of(path_);
  // From its first moment on no other user may connect.
  const auto before = ::umask(0777 & ~access_for_owner_and_group);
  const bool bound = ::bind(descriptor_, generic(address), sizeof address) == 0;
  const int error = errno;
  ::umask(before);
  if (!bound) return "cannot create the socket " + path_ + because(error);
  inode_ = inode_of(path_);
  if (::listen(descriptor_, waiting_connections) != 0)
    return "cannot listen on " + path_ + because(errno);
  return {};
}

SocketFile::SocketFile(SocketFile&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::move(other.lock_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      inode_(std::exchange(other.inode_, 0)),
      was_passed_(other.was_passed_) {}

SocketFile::~SocketFile() {
  remove();
  if (descriptor_ >= 0) ::close(descriptor_);
}

int SocketFile::release_descriptor() { return std::exchange(descriptor_, -1); }

void SocketFile::remove() {
  if (inode_ != 0 && inode_of(path_) == inode_) ::unlink(path_.c_str());
  inode_ = 0;
  lock_.release();
}

}  // namespace tmcld

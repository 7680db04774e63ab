#include "broker/password_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <sys/stat.h>

namespace tmclmqtt {
namespace {

constexpr std::size_t longest = 4096;

}  // namespace

tl::expected<std::string, std::string> password_in(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "re"),
                                                             &std::fclose);
  struct stat status {};
  std::string text(longest + 2, '\0');
  const bool is_open = file && ::fstat(::fileno(file.get()), &status) == 0;
  if (is_open) text.resize(std::fread(text.data(), 1, text.size(), file.get()));
  if (!is_open || std::ferror(file.get()) != 0)
    return tl::unexpected(path + ": cannot be read: " + std::strerror(errno));
  // A pipe from another program is that program's and this one's.
  if (S_ISREG(status.st_mode) && (status.st_mode & S_IRWXO) != 0)
    return tl::unexpected(path + ": other users may open it; try `chmod o-rwx " + path + "`");
  auto password = text.substr(0, text.find('\n'));
  if (password.ends_with('\r')) password.pop_back();
  // The library takes it up to its first zero.
  if (password.empty() || password.size() > longest || password.find('\0') != password.npos)
    return tl::unexpected(path + ": its first line must be the password, of 1 to 4096 bytes");
  return password;
}

}  // namespace tmclmqtt

#include "link/file_owner.hpp"

#include <grp.h>
#include <pwd.h>
#include <sys/stat.h>

namespace tmcl {

std::optional<FileOwner> owner_of(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return std::nullopt;
  constexpr mode_t use = S_IRGRP | S_IWGRP;
  const auto* user = ::getpwuid(status.st_uid);
  const auto* group = ::getgrgid(status.st_gid);
  return FileOwner{user != nullptr ? user->pw_name : std::to_string(status.st_uid),
                   group != nullptr ? group->gr_name : std::to_string(status.st_gid), status.st_gid,
                   (status.st_mode & use) == use};
}

}  // namespace tmcl

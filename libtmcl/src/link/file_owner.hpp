/// Who owns a file, and whether its group may use it; for hints.
#pragma once

#include <optional>
#include <string>

#include <sys/types.h>

namespace tmcl {

struct FileOwner {
  std::string user;  ///< Its number if it has no name; the group the same.
  std::string group;
  gid_t group_id = 0;
  bool group_may_use = false;  ///< Read and write.
};

/// Empty if the file cannot be looked at.
std::optional<FileOwner> owner_of(const std::string& path);

}  // namespace tmcl

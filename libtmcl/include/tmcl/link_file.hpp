/// The symbolic link by which hosts find a pseudo terminal under a name that stays the same.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace tmcl {

class LinkFile {
 public:
  /// Makes `path` lead to `target`. Replaces a link that leads nowhere, or to `target` already, as
  /// an earlier run that was killed leaves behind; refuses to touch anything else. The error is a
  /// sentence that says what to do.
  static tl::expected<LinkFile, std::string> create(const std::filesystem::path& path,
                                                    const std::filesystem::path& target);

  LinkFile(LinkFile&& other) noexcept
      : path_(std::exchange(other.path_, {})), target_(std::move(other.target_)) {}
  LinkFile& operator=(LinkFile&&) = delete;
  /// Removes the link, unless another program made it lead elsewhere meanwhile.
  ~LinkFile();

  const std::filesystem::path& path() const { return path_; }

 private:
  LinkFile(std::filesystem::path path, std::filesystem::path target)
      : path_(std::move(path)), target_(std::move(target)) {}

  std::filesystem::path path_;
  std::filesystem::path target_;
};

}  // namespace tmcl

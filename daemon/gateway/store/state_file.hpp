/// A small file of what the gateway has to know when it runs again: only its user writes it,
/// and it is there as a whole or as it was before. These functions block.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

namespace tmcld {

/// What stands in it; nothing where there is none. Errors, in words: also a file that other users
/// could write.
tl::expected<std::optional<std::string>, std::string> read_state_file(const std::string& path);
/// Writes beside it, and renames. Empty if all went well, or what did not.
std::string replace_state_file(const std::string& path, const std::string& text);
/// The same; there may be none.
std::string remove_state_file(const std::string& path);

/// A text that lies beside a file, whole and on the disk, and is to take its place. What could fail
/// for want of room has happened then. Move-only; without put_in_place() it is removed.
class StagedFile {
 public:
  /// Readable for the group. Errors, in words.
  static tl::expected<StagedFile, std::string> write(std::string path, std::string_view text);

  StagedFile(StagedFile&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  StagedFile& operator=(StagedFile&&) = delete;
  ~StagedFile();

  /// Once. Empty if all went well, or what did not: it may have taken the place, or not.
  std::string put_in_place();

 private:
  explicit StagedFile(std::string path) : path_(std::move(path)) {}

  std::string path_;  ///< Empty: there is nothing to remove.
};

}  // namespace tmcld

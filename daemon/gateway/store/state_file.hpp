/// A small file of what the gateway has to know when it runs again: only its user writes it,
/// and it is there as a whole or as it was before. These functions block.
#pragma once

#include <optional>
#include <string>

#include <tl/expected.hpp>

namespace tmcld {

/// What stands in it; nothing where there is none. Errors, in words: also a file that other users
/// could write.
tl::expected<std::optional<std::string>, std::string> read_state_file(const std::string& path);
/// Writes beside it, and renames. Empty if all went well, or what did not.
std::string replace_state_file(const std::string& path, const std::string& text);
/// The same; there may be none.
std::string remove_state_file(const std::string& path);

}  // namespace tmcld

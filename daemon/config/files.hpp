/// The files that a configuration is made of: one by name, and those beside it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/text_problem.hpp"

namespace tmcld {

/// Besides the one that is named.
constexpr std::size_t max_drop_ins = 64;

struct ConfigFile {
  std::string path;
  std::string text;
};

/// The file, and after it all of NAME.d/*.toml beside it by the order of their names, where
/// NAME.toml is the file: of /etc/tmcl/tmcld.toml those in /etc/tmcl/tmcld.d. That directory may be
/// missing.
/// Errors: why the file, or the directory, is not taken as a whole.
tl::expected<std::vector<ConfigFile>, tmcl::TextProblem> read_config_files(const std::string& path);

/// What stands in the file that clients may set; nothing where there is none. It belongs to root,
/// to this user, or to the one who has its folder: others than tmcld read it, too.
/// Errors: as above.
tl::expected<std::optional<ConfigFile>, tmcl::TextProblem> read_managed_file(
    const std::string& path);

}  // namespace tmcld

/// A file of settings, as `tmclctl settings save` writes it and people change it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "tmcl/settings.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcld {

/// Longer than the settings of any model.
constexpr std::size_t max_settings_bytes = 256 << 10;

/// Every value is one that the model has as a setting, and within its range where no unit mode
/// changes that. The file may leave settings out. Problems name line and key, and what else
/// may have been meant.
tl::expected<tmcl::Settings, tmcl::TextProblems> parse_settings(std::string_view text);

/// The same of the file of this name; also a problem: that it cannot be read.
tl::expected<tmcl::Settings, tmcl::TextProblems> read_settings_file(const std::string& path);

}  // namespace tmcld

/// From a configuration file to a Config that can be relied on.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "config/config.hpp"
#include "config/problem.hpp"

namespace tmcld {

/// Errors: everything that is wrong, in the order of the text. Never throws.
tl::expected<Config, std::vector<ConfigProblem>> parse_config(std::string_view toml);

/// Errors: one line each, "FILE:LINE:COLUMN: what is wrong", or why the file cannot be read.
tl::expected<Config, std::vector<std::string>> load_config(const std::string& path);

}  // namespace tmcld

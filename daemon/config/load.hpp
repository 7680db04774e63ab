/// From a configuration file to a Config that can be relied on.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "config/config.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcld {

/// Errors: everything that is wrong, in the order of the text. Never throws.
tl::expected<Config, tmcl::TextProblems> parse_config(std::string_view toml);

struct LoadedConfig {
  Config config;
  std::size_t files = 1;
};

/// From the file and those beside it: see read_config_files(). After them comes the one that
/// clients may set, if [daemon] names one and it is there.
/// Errors: one line each, "FILE:LINE:COLUMN: what is wrong", or why a file cannot be read.
tl::expected<LoadedConfig, std::vector<std::string>> load_config(const std::string& path);

/// As a daemon with this text in the file that clients may set, whatever stands there now. Without
/// a text: as load_config(). Errors: one without a line if a file cannot be read, or all that is
/// wrong in the files.
tl::expected<Config, tmcl::TextProblems> load_config_with(
    const std::string& path, const std::optional<std::string>& managed);
/// As load_config() has them.
std::vector<std::string> lines_of(const tmcl::TextProblems& problems);

/// For a gateway on one link: [daemon] may be missing, and is ignored with the file that it names.
/// The link takes the place of that of the only bus, or of the bus that has this link; no other bus
/// is kept, nor its axes. Errors: as load_config(); also which buses there are, if none fits.
tl::expected<Config, std::vector<std::string>> load_config_for_link(const std::string& path,
                                                                    const tmcl::LinkName& link);
/// The same where there is no file: one bus, called "direct".
Config config_for_link(const tmcl::LinkName& link);

}  // namespace tmcld

/// What was measured of one module, as a file.
///
///     [module]
///     model = "TMCM-1110"
///     firmware_version = "1.13"
///     answer_us = 1840
///     last_step = "r3"
///     ...
///     [[point]]
///     # how that was found, for people
///
/// The keys of [module] are these three and the names of the traits (tmcl/module_traits.hpp); only
/// model must be there. What stands in [[point]] is not read.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "tmcl/module_traits.hpp"

namespace tmcl {

struct ModuleFile {
  const Model* model = nullptr;    ///< Never null in what was read.
  std::string firmware_version{};  ///< "1.13"; empty if it does not say.
  std::optional<std::chrono::microseconds> to_answer{};
  ModuleTraits traits{};
};

/// The error is a sentence that begins with name and line, and names the nearest key or word.
tl::expected<ModuleFile, std::string> parse_module_file(std::string_view text,
                                                        std::string_view name);
tl::expected<ModuleFile, std::string> read_module_file(const std::string& path);

}  // namespace tmcl

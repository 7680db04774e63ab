/// What one module is like, as a file: the keys of a [[module]] of a bench file that are about its
/// firmware, under [module].
///
///     [module]
///     model = "TMCM-1110"
///     firmware_version = "1.13"
///     answer_us = 1840
///     last_step = "r3"
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "sim/module/module_settings.hpp"
#include "tmcl/model.hpp"

namespace tmclsim {

/// The error is a sentence that begins with name and line, and names the nearest key or word; also
/// for a file of another model.
tl::expected<tmcl::sim::ModuleSettings, std::string> parse_module_file(std::string_view text,
                                                                       std::string_view name,
                                                                       const tmcl::Model& model);
tl::expected<tmcl::sim::ModuleSettings, std::string> read_module_file(const std::string& path,
                                                                      const tmcl::Model& model);

}  // namespace tmclsim

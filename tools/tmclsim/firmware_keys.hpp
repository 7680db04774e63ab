/// The keys that say what a module and its firmware are like.
#pragma once

#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "sim/module/module_settings.hpp"
#include "tmcl/model.hpp"

namespace tmclsim {

/// "model" and those that settings_of() reads, but for "as".
std::vector<std::string_view> firmware_keys();

// Both throw what toml_reading.hpp throws.
const tmcl::Model& model_of(const toml::table& table);
tmcl::sim::ModuleSettings settings_of(const toml::table& table, const tmcl::Model& model);

}  // namespace tmclsim

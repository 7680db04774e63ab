/// What the keys say that a module and its firmware are like.
#pragma once

#include <toml++/toml.h>

#include "sim/module/module_settings.hpp"
#include "tmcl/model.hpp"

namespace tmclsim {

/// Of measured_keys() and "as". Throws what toml_reading.hpp throws.
tmcl::sim::ModuleSettings settings_of(const toml::table& table, const tmcl::Model& model);

}  // namespace tmclsim

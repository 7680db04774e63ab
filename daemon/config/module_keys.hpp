/// What files say of one module: the keys under [module] in a file about what
/// was measured, and those of a [[module]] of a bench file that are about the same.
#pragma once

#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "tmcl/model.hpp"
#include "tmcl/module_traits.hpp"

namespace tmcld {

/// "model", what only a simulated module has an ear for, and the names of all traits.
std::vector<std::string_view> measured_keys();

// These throw what toml_reading.hpp throws.
const tmcl::Model& model_of(const toml::table& module);
void take_traits(const toml::table& module, const tmcl::Model& model, tmcl::ModuleTraits& traits);
/// The section [module] of a file, which has no others; its keys are known.
const toml::table& measured_module(const toml::table& file);

}  // namespace tmcld

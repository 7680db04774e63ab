#include "config/module_keys.hpp"

#include <array>

#include "config/toml_reading.hpp"

namespace tmcld {

std::vector<std::string_view> measured_keys() {
  std::vector<std::string_view> keys{"model", "firmware_version", "behaviour", "answer_us",
                                     "data_logger"};
  for (const auto& info : tmcl::trait_table()) keys.push_back(info.name);
  return keys;
}

const tmcl::Model& model_of(const toml::table& module) {
  const auto* node = module.get("model");
  if (node == nullptr) complain(module, "this module has no 'model'");
  const auto* name = node->as_string();
  if (name == nullptr) complain(*node, "'model' must be a name, such as \"TMCM-1110\"");
  const auto* model = tmcl::find_model(name->get());
  if (model != nullptr) return *model;
  std::vector<std::string_view> names;
  for (const auto& known : tmcl::models()) names.push_back(known.name);
  complain(*node, "there is no module " + tmcl::quoted(name->get()) + "." +
                      tmcl::did_you_mean(name->get(), names));
}

void take_traits(const toml::table& module, const tmcl::Model& model, tmcl::ModuleTraits& traits) {
  for (const auto& info : tmcl::trait_table()) {
    const auto* node = module.get(info.name);
    if (node == nullptr) continue;
    const auto variant = tmcl::parse_variant(info, word(*node, info.name, info.variants[0]));
    if (!variant) complain(*node, tmcl::quoted(info.name) + " " + variant.error());
    // The first is what a module does that has no choice.
    if (*variant != 0 && !tmcl::concerns(info.trait, model))
      complain(*node, "a " + std::string(model.name) +
                          " has no TMC429: " + tmcl::quoted(info.name) + " can only be " +
                          std::string(info.variants[0]));
    traits.set(info.trait, *variant);
  }
}

const toml::table& measured_module(const toml::table& file) {
  want_known_keys(file, std::array<std::string_view, 1>{"module"});
  const auto* table = file["module"].as_table();
  if (table == nullptr) throw Wrong{file.source().begin, "there is no section [module]"};
  want_known_keys(*table, measured_keys());
  return *table;
}

}  // namespace tmcld

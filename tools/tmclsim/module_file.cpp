#include "module_file.hpp"

#include <array>
#include <chrono>

#include "firmware_keys.hpp"
#include "settings_words.hpp"
#include "tmcl/module_traits.hpp"
#include "toml_reading.hpp"

namespace tmclsim {
namespace {

using tmcl::sim::ModuleSettings;

constexpr std::int64_t greatest_answer_us = 1'000'000;

void take_traits(const toml::table& table, const tmcl::Model& model, tmcl::ModuleTraits& traits) {
  for (const auto& info : tmcl::trait_table()) {
    const auto* node = table.get(info.name);
    if (node == nullptr) continue;
    const auto variant = tmcl::parse_variant(info, word(*node, info.name, info.variants[0]));
    if (!variant) complain(*node, quoted(info.name) + " " + variant.error());
    // The first is what a module does that has no choice.
    if (*variant != 0 && !tmcl::concerns(info.trait, model))
      complain(*node, "a " + std::string(model.name) + " has no TMC429: " + quoted(info.name) +
                          " can only be " + std::string(info.variants[0]));
    traits.set(info.trait, *variant);
  }
}

ModuleSettings settings_in(const toml::table& root, const tmcl::Model& model) {
  want_known_keys(root, std::array<std::string_view, 1>{"module"});
  const auto* table = root["module"].as_table();
  if (table == nullptr) throw Wrong{root.source().begin, "there is no section [module]"};
  want_known_keys(*table, firmware_keys());
  const auto& its_model = model_of(*table);
  if (&its_model != &model) {
    complain(*table->get("model"),
             "this is a " + std::string(its_model.name) + ", not a " + std::string(model.name));
  }
  return settings_of(*table, model);
}

}  // namespace

std::vector<std::string_view> firmware_keys() {
  std::vector<std::string_view> keys{"model", "firmware_version", "behaviour", "answer_us",
                                     "data_logger"};
  for (const auto& info : tmcl::trait_table()) keys.push_back(info.name);
  return keys;
}

const tmcl::Model& model_of(const toml::table& table) {
  const auto* node = table.get("model");
  if (node == nullptr) complain(table, "this module has no 'model'");
  const auto* name = node->as_string();
  if (name == nullptr) complain(*node, "'model' must be a name, such as \"TMCM-1110\"");
  const auto* model = tmcl::find_model(name->get());
  if (model != nullptr) return *model;
  std::vector<std::string_view> names;
  for (const auto& known : tmcl::models()) names.push_back(known.name);
  complain(*node, "there is no module " + quoted(name->get()) + "." +
                      tmcl::did_you_mean(name->get(), names));
}

ModuleSettings settings_of(const toml::table& table, const tmcl::Model& model) {
  ModuleSettings settings;
  if (const auto* node = table.get("as")) {
    const auto file = read_module_file(word(*node, "as", "module.toml"), model);
    if (!file) complain(*node, file.error());
    settings = *file;
  }
  if (const auto* node = table.get("firmware_version")) {
    const auto text = word(*node, "firmware_version", "1.09");
    settings.firmware = parse_release(text);
    if (!settings.firmware) complain(*node, quoted(text) + std::string(no_release));
  }
  take_word(table, "behaviour", parse_behaviour, settings.behaviour);
  take_traits(table, model, settings.traits);
  if (const auto us = number(table, "answer_us", {0, greatest_answer_us}))
    settings.to_answer = std::chrono::microseconds(*us);
  take(table, "data_logger", settings.data_logger);
  return settings;
}

ModuleFile parse_module_file(std::string_view text, std::string_view name,
                             const tmcl::Model& model) {
  return parsed<ModuleSettings>(text, name,
                                [&](const toml::table& root) { return settings_in(root, model); });
}

ModuleFile read_module_file(const std::string& path, const tmcl::Model& model) {
  const auto text = text_of_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_module_file(*text, path, model);
}

}  // namespace tmclsim

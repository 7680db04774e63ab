#include "module_file.hpp"

#include <chrono>

#include "config/module_keys.hpp"
#include "config/toml_reading.hpp"
#include "firmware_keys.hpp"
#include "settings_words.hpp"

namespace tmclsim {

using namespace tmcld;  // how TOML is read

namespace {

using tmcl::sim::ModuleSettings;

constexpr std::int64_t greatest_answer_us = 1'000'000;

ModuleSettings settings_in(const toml::table& root, const tmcl::Model& model) {
  const auto& table = measured_module(root);
  const auto& its_model = model_of(table);
  if (&its_model != &model) {
    complain(*table.get("model"),
             "this is a " + std::string(its_model.name) + ", not a " + std::string(model.name));
  }
  return settings_of(table, model);
}

}  // namespace

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

tl::expected<tmcl::sim::ModuleSettings, std::string> parse_module_file(std::string_view text,
                                                                       std::string_view name,
                                                                       const tmcl::Model& model) {
  return parsed<ModuleSettings>(text, name,
                                [&](const toml::table& root) { return settings_in(root, model); });
}

tl::expected<tmcl::sim::ModuleSettings, std::string> read_module_file(const std::string& path,
                                                                      const tmcl::Model& model) {
  const auto text = text_of_file(path);
  if (!text) return tl::unexpected(text.error());
  return parse_module_file(*text, path, model);
}

}  // namespace tmclsim

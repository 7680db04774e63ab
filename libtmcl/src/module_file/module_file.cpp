#include "module_file/module_file.hpp"

#include <toml++/toml.h>

#include <fstream>
#include <sstream>
#include <vector>

#include "tmcl/spelling.hpp"

namespace tmcl {
namespace {

constexpr std::int64_t longest_answer_us = 1'000'000;

// Thrown within this file only: the way out of nested tables.
struct Wrong {
  toml::source_position where;
  std::string sentence;
};

[[noreturn]] void complain(toml::source_position where, std::string sentence) {
  throw Wrong{where, std::move(sentence)};
}

void want_known_keys(const toml::table& table, const std::vector<std::string_view>& known) {
  for (const auto& [key, node] : table) {
    if (std::ranges::find(known, key.str()) != known.end()) continue;
    complain(key.source().begin,
             "there is no key " + quoted(key.str()) + "." + did_you_mean(key.str(), known));
  }
}

std::string text_of(const toml::node& node, std::string_view key) {
  const auto* text = node.as_string();
  if (text != nullptr) return text->get();
  complain(node.source().begin, quoted(key) + " must be a text in quotes");
}

const Model& model_of(const toml::table& table) {
  const auto* node = table.get("model");
  if (node == nullptr) complain(table.source().begin, "[module] has no 'model'");
  const auto name = text_of(*node, "model");
  if (const auto* model = find_model(name)) return *model;
  std::vector<std::string_view> names;
  for (const auto& known : models()) names.push_back(known.name);
  complain(node->source().begin,
           "there is no module " + quoted(name) + "." + did_you_mean(name, names));
}

std::chrono::microseconds answer_time(const toml::node& node) {
  const auto* number = node.as_integer();
  if (number != nullptr && number->get() >= 0 && number->get() <= longest_answer_us)
    return std::chrono::microseconds(number->get());
  complain(node.source().begin, "'answer_us' must be 0 to 1000000, in microseconds");
}

ModuleTraits traits_of(const toml::table& table, const Model& model) {
  ModuleTraits traits;
  for (const auto& info : trait_table()) {
    const auto* node = table.get(info.name);
    if (node == nullptr) continue;
    const auto variant = parse_variant(info, text_of(*node, info.name));
    if (!variant) complain(node->source().begin, quoted(info.name) + " " + variant.error());
    if (!concerns(info.trait, model))
      complain(node->source().begin, quoted(info.name) + " is of modules with a TMC429, and a " +
                                         std::string(model.name) + " has none");
    traits.set(info.trait, *variant);
  }
  return traits;
}

ModuleFile file_of(const toml::table& root) {
  want_known_keys(root, {"module", "point"});
  const auto* table = root["module"].as_table();
  if (table == nullptr) complain(root.source().begin, "there is no section [module]");
  std::vector<std::string_view> known{"model", "firmware_version", "answer_us"};
  for (const auto& info : trait_table()) known.push_back(info.name);
  want_known_keys(*table, known);
  ModuleFile file{&model_of(*table)};
  if (const auto* node = table->get("firmware_version"))
    file.firmware_version = text_of(*node, "firmware_version");
  if (const auto* node = table->get("answer_us")) file.to_answer = answer_time(*node);
  file.traits = traits_of(*table, *file.model);
  return file;
}

std::string sentence_at(std::string_view name, toml::source_position where,
                        std::string_view sentence) {
  return std::string(name) + ":" + std::to_string(where.line) + ": " + std::string(sentence);
}

}  // namespace

tl::expected<ModuleFile, std::string> parse_module_file(std::string_view text,
                                                        std::string_view name) try {
  return file_of(toml::parse(text));
} catch (const toml::parse_error& error) {
  return tl::unexpected(sentence_at(name, error.source().begin, error.description()));
} catch (const Wrong& wrong) {
  return tl::unexpected(sentence_at(name, wrong.where, wrong.sentence));
}

tl::expected<ModuleFile, std::string> read_module_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf()))
    return tl::unexpected(path + ": cannot be read, or is empty");
  return parse_module_file(text.str(), path);
}

}  // namespace tmcl

/// Reading TOML that people write: what is wrong is said with its line and the nearest key.
#pragma once

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>

#include <toml++/toml.h>
#include <tl/expected.hpp>

#include "tmcl/spelling.hpp"

namespace tmcld {

using tmcl::quoted;

struct Range {
  std::int64_t least;
  std::int64_t most;
};

/// Thrown by all of these: the way out of nested tables. parsed() catches it.
struct Wrong {
  toml::source_position where;
  std::string sentence;
};

[[noreturn]] inline void complain(const toml::node& node, std::string sentence) {
  throw Wrong{node.source().begin, std::move(sentence)};
}

inline void want_known_keys(const toml::table& table, std::span<const std::string_view> known) {
  for (const auto& [key, node] : table) {
    if (std::ranges::find(known, key.str()) != known.end()) continue;
    throw Wrong{key.source().begin, "there is no key " + quoted(key.str()) + "." +
                                        tmcl::did_you_mean(key.str(), known)};
  }
}

inline std::int64_t number(const toml::node& node, std::string_view key, Range range) {
  const auto* integer = node.as_integer();
  if (integer == nullptr) complain(node, quoted(key) + " must be a whole number");
  const auto value = integer->get();
  if (value < range.least || value > range.most) {
    complain(node, quoted(key) + " is " + std::to_string(value) + ", but must be " +
                       std::to_string(range.least) + " to " + std::to_string(range.most));
  }
  return value;
}

inline std::optional<std::int64_t> number(const toml::table& table, std::string_view key,
                                          Range range) {
  const auto* node = table.get(key);
  if (node == nullptr) return std::nullopt;
  return number(*node, key, range);
}

template <class Integer>
void take(const toml::table& table, std::string_view key, Range range, Integer& target) {
  if (const auto value = number(table, key, range)) target = static_cast<Integer>(*value);
}

inline void take(const toml::table& table, std::string_view key, bool& target) {
  const auto* node = table.get(key);
  if (node == nullptr) return;
  if (!node->is_boolean()) complain(*node, quoted(key) + " must be true or false");
  target = node->as_boolean()->get();
}

inline void take(const toml::table& table, std::string_view key, std::optional<bool>& target) {
  if (table.get(key) == nullptr) return;
  target.emplace();
  take(table, key, *target);
}

inline std::string word(const toml::node& node, std::string_view key, std::string_view example) {
  const auto* text = node.as_string();
  if (text != nullptr) return text->get();
  complain(node,
           quoted(key) + " must be a text in quotes, such as \"" + std::string(example) + "\"");
}

template <class Value>
void take_word(const toml::table& table, std::string_view key,
               tl::expected<Value, std::string> (*parse)(std::string_view), Value& target) {
  const auto* node = table.get(key);
  if (node == nullptr) return;
  const auto value = parse(word(*node, key, "manual"));
  if (!value) complain(*node, quoted(key) + " " + value.error());
  target = *value;
}

/// What `read` makes of the text. The error begins with name and line.
template <class Value, class Read>
tl::expected<Value, std::string> parsed(std::string_view text, std::string_view name,
                                        const Read& read) {
  const auto at = [&](toml::source_position where, std::string_view sentence) {
    return tl::unexpected(std::string(name) + ":" + std::to_string(where.line) + ": " +
                          std::string(sentence));
  };
  try {
    return read(toml::parse(text));
  } catch (const toml::parse_error& error) {
    return at(error.source().begin, error.description());
  } catch (const Wrong& wrong) {
    return at(wrong.where, wrong.sentence);
  }
}

inline tl::expected<std::string, std::string> text_of_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file && (text << file.rdbuf())) return text.str();
  return tl::unexpected(path + ": cannot be read, or is empty");
}

}  // namespace tmcld

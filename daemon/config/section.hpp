/// The sections of a configuration file as they stand there, free of the TOML library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "config/keys.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcld {

using ConfigRange = std::array<double, 2>;
using ConfigTexts = std::vector<std::string>;

/// A place in a text; line and column count from one.
struct Place {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string file{};  ///< Its path; empty where there is one text alone.

  tmcl::TextProblem problem(std::string message) const {
    return {line, column, std::move(message), {}, file};
  }
};

struct ConfigValue {
  std::variant<std::string, std::int64_t, double, bool, ConfigRange, ConfigTexts> value;
  Place place;
};

/// Its values have the types and lie in the ranges that the table of keys asks for.
struct ConfigSection {
  SectionKind kind;
  Place place;
  std::map<std::string_view, ConfigValue> values;

  const ConfigValue* find(std::string_view key) const {
    const auto found = values.find(key);
    return found == values.end() ? nullptr : &found->second;
  }
  /// Null if the key is absent.
  template <class T>
  const T* get(std::string_view key) const {
    const auto* entry = find(key);
    return entry == nullptr ? nullptr : std::get_if<T>(&entry->value);
  }
  Place place_of(std::string_view key) const {
    const auto* entry = find(key);
    return entry == nullptr ? place : entry->place;
  }
};

struct ConfigText {
  bool is_toml = true;        ///< If not, there are no sections, and one problem.
  bool names_daemon = false;  ///< Its section, right or wrong.
  std::vector<ConfigSection> sections;
  tmcl::TextProblems problems;
};

enum class DaemonSection : std::uint8_t { read, ignored };

/// Reads TOML and checks every key against the table of keys. Never throws.
ConfigText read_sections(std::string_view toml, DaemonSection daemon);

}  // namespace tmcld

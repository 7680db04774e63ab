/// What the sections of a configuration file are made of. A key is declared once: what it is, what
/// it is called in C++ and in the file, what it means, and the bounds of a whole number. From that
/// come how it is read, and what is said of mistakes in it.
///
///     struct BusSection : Section {
///       TMCL_SECTION(BusSection, "[[bus]]");
///       TMCL_KEY(Needed<std::string>, link, "where it is");
///       TMCL_KEY(Said<unsigned>, attempts, "how often a command is sent", {1, 10});
///     };
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tmcl/api/field.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcld {

using ConfigRange = std::array<double, 2>;
using ConfigTexts = std::vector<std::string>;
/// By names of their own.
using ConfigNumbers = std::map<std::string, double>;
using KeyValue =
    std::variant<std::string, std::int64_t, double, bool, ConfigRange, ConfigTexts, ConfigNumbers>;

/// A place in a text; line and column count from one.
struct Place {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string file{};  ///< Its path; empty where there is one text alone.

  tmcl::TextProblem problem(std::string message) const {
    return {line, column, std::move(message), {}, file};
  }
};

/// Which key was given, and where; no name if it is missing, or wrong in itself.
struct Given {
  std::string_view key{};
  Place place{};

  tmcl::TextProblem problem(std::string message) const { return place.problem(std::move(message)); }
};

/// What a key was given; nothing if it is missing, or wrong in itself.
template <class T>
struct Said : Given, std::optional<T> {
  static constexpr bool is_required = false;
};
/// The same of a key that no section may lack.
template <class T>
struct Needed : Said<T> {
  static constexpr bool is_required = true;
};

struct Section {
  Place place{};
  std::string text{};  ///< The same for sections that say the same, wherever they stand.
};

enum class KeyType : std::uint8_t { string, strings, integer, number, numbers, boolean, range };

struct Key {
  std::string_view name;
  std::string_view meaning;
  KeyType type;
  bool is_required;
  tmcl::api::Bounds bounds;  ///< Of an integer.
  /// The value is of the type, and within the bounds.
  Given& (*put)(Section& section, KeyValue value);
};

// ---- rows ----

/// Whole numbers, and times, which are counted in the unit that the name of the key ends with.
template <class T>
constexpr KeyType key_type_of = KeyType::integer;
template <>
inline constexpr KeyType key_type_of<std::string> = KeyType::string;
template <>
inline constexpr KeyType key_type_of<ConfigTexts> = KeyType::strings;
template <>
inline constexpr KeyType key_type_of<double> = KeyType::number;
template <>
inline constexpr KeyType key_type_of<ConfigNumbers> = KeyType::numbers;
template <>
inline constexpr KeyType key_type_of<bool> = KeyType::boolean;
template <>
inline constexpr KeyType key_type_of<ConfigRange> = KeyType::range;

template <class T>
Given& put_value(Said<T>& said, KeyValue value) {
  if constexpr (key_type_of<T> == KeyType::integer)
    said.emplace(static_cast<T>(std::get<std::int64_t>(value)));
  else
    said.emplace(std::get<T>(std::move(value)));
  return said;
}

template <auto member>
using ValueOf = typename decltype(tmcl::api::value_of(member))::value_type;

template <auto member, class Object>
constexpr Key key(std::string_view meaning,
                  tmcl::api::Bounds bounds = tmcl::api::bounds_of<ValueOf<member>>()) {
  return {tmcl::api::name_of<member>(),
          meaning,
          key_type_of<ValueOf<member>>,
          decltype(tmcl::api::value_of(member))::is_required,
          bounds,
          [](Section& section, KeyValue value) -> Given& {
            return put_value(static_cast<Object&>(section).*member, std::move(value));
          }};
}

// ---- declarations ----

/// `called`: as in a file, "[daemon]" if there is one, "[[bus]]" if there may be several.
#define TMCL_SECTION(Name, called)                 \
  static constexpr std::string_view title{called}; \
  TMCL_STRUCT(Name)

#define TMCL_KEY(Type, name, ...)                                               \
  template <class Object>                                                       \
  static constexpr ::tmcld::Key row_of(Declared, ::tmcl::api::Line<__LINE__>) { \
    return ::tmcld::key<&Object::name, Object>(__VA_ARGS__);                    \
  }                                                                             \
  Type name {}

}  // namespace tmcld

/// What the structs of the methods are made of. A field is declared once: what it is, what it is
/// called in C++ and in JSON, what it means, and the bounds of an integer. From that come the JSON
/// of requests and answers, on both sides, rpc.discover, and the tables of docs/PROTOCOL.md.
///
///     struct MoveTo {
///       TMCL_METHOD("axis.move_to", moves, StartedMove, "starts a move to a position", MoveTo);
///       TMCL_FIELD(std::string, axis, "name of the axis");
///       TMCL_FIELD(std::optional<std::int32_t>, position_microsteps, "where to go");
///       TMCL_FIELD(std::optional<std::uint16_t>, deadline_ms, "not sent later", {1, 5000});
///     };
///     const MoveTo move{.axis = "x", .position_microsteps = 5120};
///
/// A struct that is no method has TMCL_STRUCT(Name) in its first line; one with a base names that,
/// too: TMCL_STRUCT(Name, Base). In a method, and in a struct that says so by `omits_absent`, an
/// optional without a value is left out; elsewhere it is null.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/value.hpp>

#include "tmcl/command.hpp"
#include "tmcl/quantity.hpp"

namespace tmcl::api {

enum class FieldType : std::uint8_t {
  text,
  integer,
  number,
  boolean,
  text_or_integer,
  text_or_object,
  quantity,  ///< A number, or a text with its unit, such as "12.5mm".
  object,
  texts,  ///< An array of texts; those that follow are arrays, too.
  integers,
  numbers,
  number_lists,  ///< An array of arrays of numbers.
  quantities,
  objects,
};
/// "array of strings"
std::string_view name_of(FieldType type);

/// What a method is called, and what a call can do to a machine at most.
struct Method {
  std::string_view name;  ///< noun.verb
  Effect effect;
  std::string_view summary;
};

/// A position, a distance or a velocity: a number in the unit of the axis, or a text with its unit.
struct Amount {
  Amount(double in_unit_of_axis = 0) : said(in_unit_of_axis) {}
  Amount(std::string with_unit) : said(std::move(with_unit)) {}
  Amount(const char* with_unit) : said(std::string(with_unit)) {}
  Amount(const Quantity& quantity) : said(to_string(quantity)) {}
  std::variant<double, std::string> said;
};

/// Such as of a parameter.
struct NameOrNumber {
  NameOrNumber(std::int32_t number = 0) : said(number) {}
  NameOrNumber(std::string name) : said(std::move(name)) {}
  NameOrNumber(const char* name) : said(std::string(name)) {}
  std::variant<std::int32_t, std::string> said;
};

/// A word where there is nothing more to say. Only results have it.
template <class T>
struct WordOr {
  std::variant<std::string, T> said;
};

/// Of integers. Nothing outside int32 passes in a parameter.
struct Bounds {
  std::int64_t minimum = std::numeric_limits<std::int32_t>::min();
  std::int64_t maximum = std::numeric_limits<std::int32_t>::max();
};

struct Field;

struct Fields {
  std::span<const Field> rows;
  bool omits_absent = false;
};

struct Field {
  std::string_view name;
  std::string_view summary;
  FieldType type;
  bool required;  ///< Not an optional.
  std::int64_t minimum;
  std::int64_t maximum;
  /// False, and nothing changed, where the value is of another kind.
  bool (*read)(const boost::json::value& value, void* object);
  boost::json::value (*write)(const void* object);
  Fields (*inner)();  ///< Of an object or of each object; null for other types.
};

// ---- values ----

bool read_value(const boost::json::value& value, std::string& into);
bool read_value(const boost::json::value& value, double& into);
bool read_value(const boost::json::value& value, bool& into);
bool read_value(const boost::json::value& value, Amount& into);
bool read_value(const boost::json::value& value, NameOrNumber& into);
bool read_value(const boost::json::value& value, boost::json::object& into);
/// JSON knows one kind of number: 1e3 and 1000.0 are whole, too.
std::optional<std::int64_t> whole_number(const boost::json::value& value);
/// What is missing or of another kind stays as it is, so that a newer peer does no harm.
void read_fields(Fields fields, const boost::json::object& from, void* object);

boost::json::value write_value(const Amount& value);
boost::json::value write_value(const NameOrNumber& value);
boost::json::object write_fields(Fields fields, const void* object);

template <class T>
constexpr bool is_integer = std::is_integral_v<T> && !std::is_same_v<T, bool>;
template <class T>
constexpr bool is_optional = false;
template <class T>
constexpr bool is_optional<std::optional<T>> = true;
template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;
/// What a struct says of itself by TMCL_STRUCT.
template <class Self, int line, class BaseOfSelf = void>
struct Declaration {
  using Base = BaseOfSelf;
  static constexpr std::size_t first_line = line;
};
template <std::size_t>
struct Line {};
template <class T>
concept Described = requires {
  typename T::Declared;
};
template <class T>
concept IsMethod = Described<T> && requires {
  T::method;
  typename T::Result;
};

/// `Row`: what the declarations of its members make.
template <Described T, class Object = T, class Row = Field>
constexpr auto rows_of();
template <Described T>
inline constexpr auto rows = rows_of<T>();

template <class T>
constexpr bool omits_absent = IsMethod<T>;
template <class T>
requires(T::omits_absent) constexpr bool omits_absent<T> = true;

template <Described T>
Fields fields_of() {
  return {rows<T>, omits_absent<T>};
}

template <class T>
bool read_value(const boost::json::value& value, T& into) {
  if constexpr (Described<T>) {
    const auto* object = value.if_object();
    if (object != nullptr) read_fields(fields_of<T>(), *object, &into);
    return object != nullptr;
  } else if constexpr (is_integer<T>) {
    const auto number = whole_number(value);
    if (!number || !std::in_range<T>(*number)) return false;
    into = static_cast<T>(*number);
    return true;
  } else if constexpr (is_list<T>) {
    const auto* array = value.if_array();
    if (array == nullptr) return false;
    for (const auto& element : *array) {
      if (typename T::value_type one{}; read_value(element, one)) into.push_back(std::move(one));
    }
    return true;
  } else {
    static_assert(is_optional<T>);
    typename T::value_type one{};
    if (value.is_null() || !read_value(value, one)) return false;
    into = std::move(one);
    return true;
  }
}

template <class T>
bool read_value(const boost::json::value& value, WordOr<T>& into) {
  if (std::string word; read_value(value, word)) return into.said = std::move(word), true;
  T one{};
  if (!read_value(value, one)) return false;
  into.said = std::move(one);
  return true;
}

template <class T>
boost::json::value write_value(const T& value) {
  if constexpr (Described<T>) {
    return write_fields(fields_of<T>(), &value);
  } else if constexpr (is_optional<T>) {
    return value ? write_value(*value) : boost::json::value(nullptr);
  } else if constexpr (is_list<T>) {
    boost::json::array array;
    array.reserve(value.size());
    for (const auto& element : value) array.push_back(write_value(element));
    return array;
  } else {
    return boost::json::value(value);
  }
}

template <class T>
boost::json::value write_value(const WordOr<T>& value) {
  return std::visit([](const auto& said) { return boost::json::value(write_value(said)); },
                    value.said);
}

// ---- rows ----

constexpr FieldType list_of(FieldType type) {
  switch (type) {
    case FieldType::integer: return FieldType::integers;
    case FieldType::number: return FieldType::numbers;
    case FieldType::numbers: return FieldType::number_lists;
    case FieldType::quantity: return FieldType::quantities;
    case FieldType::object: return FieldType::objects;
    default: return FieldType::texts;
  }
}

template <class T>
constexpr FieldType type_of = is_integer<T> ? FieldType::integer : FieldType::object;
template <>
inline constexpr FieldType type_of<std::string> = FieldType::text;
template <>
inline constexpr FieldType type_of<double> = FieldType::number;
template <>
inline constexpr FieldType type_of<bool> = FieldType::boolean;
template <>
inline constexpr FieldType type_of<Amount> = FieldType::quantity;
template <>
inline constexpr FieldType type_of<NameOrNumber> = FieldType::text_or_integer;
template <class T>
inline constexpr FieldType type_of<WordOr<T>> = FieldType::text_or_object;
template <class T>
constexpr FieldType type_of<std::optional<T>> = type_of<T>;
template <class T>
constexpr FieldType type_of<std::vector<T>> = list_of(type_of<T>);

/// What is left of optionals and lists.
template <class T>
struct Element {
  using Type = T;
};
template <class T>
requires is_optional<T> || is_list<T>
struct Element<T> : Element<typename T::value_type> {
};

template <class T>
struct Element<WordOr<T>> : Element<T> {};

template <class T>
constexpr Bounds bounds_of() {
  using Type = typename Element<T>::Type;
  if constexpr (is_integer<Type> && sizeof(Type) < sizeof(std::int32_t))
    return {std::numeric_limits<Type>::min(), std::numeric_limits<Type>::max()};
  return {};
}

/// What a member is called.
template <auto member>
constexpr std::string_view name_of() {
  std::string_view text = __PRETTY_FUNCTION__;  // ...[with auto member = &tmcl::api::Struct::name]
  text.remove_prefix(text.find("member = "));
  text = text.substr(0, text.find_first_of(";]"));
  text = text.substr(text.rfind(':') + 1);
  // Brackets stand around the whole (g++), or around an unnamed namespace (clang).
  return text.substr(0, text.find(')'));
}

template <class Object, class T>
T value_of(T Object::*);

/// The row of a member of `Object`, or of its base.
template <auto member, class Object>
constexpr Field field(std::string_view summary,
                      Bounds bounds = bounds_of<decltype(value_of(member))>()) {
  using Value = decltype(value_of(member));
  using Inner = typename Element<Value>::Type;
  Field row{
      name_of<member>(),
      summary,
      type_of<Value>,
      !is_optional<Value>,
      bounds.minimum,
      bounds.maximum,
      [](const boost::json::value& value, void* object) {
        return read_value(value, static_cast<Object*>(object)->*member);
      },
      [](const void* object) { return write_value(static_cast<const Object*>(object)->*member); },
      nullptr};
  if constexpr (Described<Inner>) row.inner = fields_of<Inner>;
  return row;
}

/// How many lines a struct may have.
constexpr std::size_t most_lines = 64;

template <class T, std::size_t line>
constexpr bool has_row = requires(typename T::Declared declared, Line<line> here) {
  T::template row_of<T>(declared, here);
};

template <class T, class Object, std::size_t here, class Row>
constexpr void add_row(Row*& next) {
  if constexpr (has_row<T, here>)
    *next++ = T::template row_of<Object>(typename T::Declared{}, Line<here>{});
}

template <class T, class Object, class Row, std::size_t... line>
constexpr auto own_rows(std::index_sequence<line...>) {
  constexpr auto first = T::Declared::first_line;
  std::array<Row, (0 + ... + has_row<T, first + line>)> own{};
  auto* next = own.data();
  (add_row<T, Object, first + line>(next), ...);
  return own;
}

/// Those of the bases come first.
template <Described T, class Object, class Row>
constexpr auto rows_of() {
  constexpr auto own = own_rows<T, Object, Row>(std::make_index_sequence<most_lines>{});
  using Base = typename T::Declared::Base;
  if constexpr (std::is_void_v<Base>) {
    return own;
  } else {
    constexpr auto inherited = rows_of<Base, Object, Row>();
    std::array<Row, inherited.size() + own.size()> all{};
    std::ranges::copy(own, std::ranges::copy(inherited, all.begin()).out);
    return all;
  }
}

// ---- declarations ----

#define TMCL_STRUCT(Name, ...) \
  using Declared = ::tmcl::api::Declaration<Name, __LINE__ __VA_OPT__(, ) __VA_ARGS__>

/// `does`: of tmcl::Effect.
#define TMCL_METHOD(called, does, Gives, means, ...)                                \
  static constexpr ::tmcl::api::Method method{called, ::tmcl::Effect::does, means}; \
  using Result = Gives;                                                             \
  TMCL_STRUCT(__VA_ARGS__)

#define TMCL_FIELD(Type, name, ...)                                                   \
  template <class Object>                                                             \
  static constexpr ::tmcl::api::Field row_of(Declared, ::tmcl::api::Line<__LINE__>) { \
    return ::tmcl::api::field<&Object::name, Object>(__VA_ARGS__);                    \
  }                                                                                   \
  Type name {}

// ---- structs ----

template <Described T>
T from_json(const boost::json::object& object) {
  T result{};
  read_fields(fields_of<T>(), object, &result);
  return result;
}

template <Described T>
boost::json::object to_json(const T& object) {
  return write_fields(fields_of<T>(), &object);
}

/// What many methods give.
struct Nothing {
  TMCL_STRUCT(Nothing);
};

}  // namespace tmcl::api

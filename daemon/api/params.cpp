#include "api/params.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/value.hpp>

#include "api/suggest.hpp"
#include "tmcl/spelling.hpp"

namespace tmcld {
namespace {

using tmcl::quoted;

namespace json = boost::json;
using api::FieldType;

bool is_whole_number(const json::value& value) {
  if (value.is_int64() || value.is_uint64()) return true;
  // JSON knows one kind of number: 1e3 and 1000.0 are whole.
  return value.is_double() && std::trunc(value.get_double()) == value.get_double();
}

bool is_quantity(const json::value& value) { return value.is_number() || value.is_string(); }

bool has_type(const json::value& value, FieldType type) {
  switch (type) {
    case FieldType::text: return value.is_string();
    case FieldType::integer: return is_whole_number(value);
    case FieldType::number: return value.is_number();
    case FieldType::boolean: return value.is_bool();
    case FieldType::integers:
      return value.is_array() && std::ranges::all_of(value.get_array(), is_whole_number);
    case FieldType::quantity: return is_quantity(value);
    case FieldType::quantities:
      return value.is_array() && std::ranges::all_of(value.get_array(), is_quantity);
    case FieldType::text_or_integer: return value.is_string() || is_whole_number(value);
    case FieldType::texts:
      return value.is_array() &&
             std::ranges::all_of(value.get_array(), [](const auto& e) { return e.is_string(); });
    case FieldType::numbers:
    case FieldType::number_lists:
    case FieldType::text_or_object:
    case FieldType::object:
    case FieldType::objects: return false;  // only results have them
  }
  return false;
}

// Compared as they came: a number too large for int64 must not wrap into the range.
bool is_within(const json::value& value, std::int64_t minimum, std::int64_t maximum) {
  if (value.is_int64()) return value.get_int64() >= minimum && value.get_int64() <= maximum;
  if (value.is_uint64()) {
    return maximum >= 0 && value.get_uint64() <= static_cast<std::uint64_t>(maximum);
  }
  return value.get_double() >= static_cast<double>(minimum) &&
         value.get_double() <= static_cast<double>(maximum);
}

std::optional<Error> check_value(const api::Field& row, const json::value& value) {
  if (!has_type(value, row.type)) {
    return param_error("bad_argument", row.name,
                       quoted(row.name) + " must be of type " + std::string(name_of(row.type)));
  }
  const auto fits = [&](const json::value& number) {
    return is_within(number, row.minimum, row.maximum);
  };
  const bool counts = row.type == FieldType::integer || row.type == FieldType::text_or_integer;
  if (counts && (value.is_string() || fits(value))) return std::nullopt;
  if (row.type == FieldType::integers && std::ranges::all_of(value.get_array(), fits))
    return std::nullopt;
  if (!counts && row.type != FieldType::integers) return std::nullopt;
  return param_error("out_of_range", row.name,
                     quoted(row.name) + " is outside " + std::to_string(row.minimum) + ".." +
                         std::to_string(row.maximum));
}

Error unknown_param(const MethodInfo& method, std::string_view name) {
  std::vector<std::string_view> known;
  for (const auto& row : method.params) known.push_back(row.name);
  return param_error("bad_argument", name,
                     std::string(method.name) + " has no parameter " + quoted(name),
                     suggest(name, known));
}

}  // namespace

std::optional<Error> check_params(const MethodInfo& method, const json::object& params) {
  for (const auto& [name, value] : params) {
    const std::string_view key(name.data(), name.size());
    const auto row = std::ranges::find(method.params, key, &api::Field::name);
    if (row == method.params.end()) return unknown_param(method, key);
    if (auto error = check_value(*row, value)) return error;
  }
  for (const auto& row : method.params) {
    if (!row.required || params.contains(row.name)) continue;
    return param_error("bad_argument", row.name,
                       std::string(method.name) + " needs the parameter " + quoted(row.name),
                       std::string(row.summary));
  }
  return std::nullopt;
}

}  // namespace tmcld

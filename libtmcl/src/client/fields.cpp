#include "tmcl/api/field.hpp"

#include <cmath>

namespace tmcl::api {

namespace json = boost::json;

std::string_view name_of(FieldType type) {
  using enum FieldType;
  switch (type) {
    case text: return "string";
    case integer: return "integer";
    case number: return "number";
    case boolean: return "boolean";
    case text_or_integer: return "string or integer";
    case text_or_object: return "string or object";
    case quantity: return "quantity";
    case object: return "object";
    case texts: return "array of strings";
    case integers: return "array of integers";
    case numbers: return "array of numbers";
    case number_lists: return "array of arrays of numbers";
    case quantities: return "array of quantities";
    case objects: return "array of objects";
  }
  return {};
}

std::optional<std::int64_t> whole_number(const json::value& value) {
  boost::system::error_code inexact;
  const auto number = value.to_number<std::int64_t>(inexact);
  return inexact ? std::nullopt : std::optional(number);
}

bool read_value(const json::value& value, std::string& into) {
  const auto* text = value.if_string();
  if (text != nullptr) into.assign(text->data(), text->size());
  return text != nullptr;
}

bool read_value(const json::value& value, double& into) {
  if (value.is_number()) into = value.to_number<double>();
  return value.is_number();
}

bool read_value(const json::value& value, bool& into) {
  if (value.is_bool()) into = value.get_bool();
  return value.is_bool();
}

bool read_value(const json::value& value, Amount& into) {
  if (std::string text; read_value(value, text)) return into = std::move(text), true;
  double number = 0;
  if (!read_value(value, number)) return false;
  into = number;
  return true;
}

bool read_value(const json::value& value, NameOrNumber& into) {
  if (std::string text; read_value(value, text)) return into = std::move(text), true;
  std::int32_t number = 0;
  if (!read_value(value, number)) return false;
  into = number;
  return true;
}

bool read_value(const json::value& value, json::object& into) {
  const auto* object = value.if_object();
  if (object != nullptr) into = *object;
  return object != nullptr;
}

void read_fields(Fields fields, const json::object& from, void* object) {
  for (const auto& row : fields.rows) {
    if (const auto* value = from.if_contains(row.name)) row.read(*value, object);
  }
}

json::value write_value(const Amount& value) {
  return std::visit([](const auto& said) { return json::value(said); }, value.said);
}

json::value write_value(const NameOrNumber& value) {
  return std::visit([](const auto& said) { return json::value(said); }, value.said);
}

json::object write_fields(Fields fields, const void* object) {
  json::object out;
  out.reserve(fields.rows.size());
  for (const auto& row : fields.rows) {
    auto value = row.write(object);
    if (!fields.omits_absent || !value.is_null()) out.emplace(row.name, std::move(value));
  }
  return out;
}

}  // namespace tmcl::api

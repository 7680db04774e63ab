#include "api/json_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <boost/json/array.hpp>
#include <boost/json/serialize.hpp>
#include <boost/json/value.hpp>

namespace tmcld {
namespace {

namespace json = boost::json;

void append(std::string& text, const json::value& value);

void append(std::string& text, double number) {
  // JSON has no way to write these.
  if (!std::isfinite(number)) {
    text += "null";
    return;
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

void append(std::string& text, const json::object& object) {
  std::string_view separator = "{";
  for (const auto& [key, value] : object) {
    text += separator;
    text += json::serialize(json::string_view(key.data(), key.size()));
    text += ':';
    append(text, value);
    separator = ",";
  }
  text += object.empty() ? "{}" : "}";
}

void append(std::string& text, const json::array& array) {
  std::string_view separator = "[";
  for (const auto& value : array) {
    text += separator;
    append(text, value);
    separator = ",";
  }
  text += array.empty() ? "[]" : "]";
}

void append(std::string& text, const json::value& value) {
  switch (value.kind()) {
    case json::kind::double_: return append(text, value.get_double());
    case json::kind::object: return append(text, value.get_object());
    case json::kind::array: return append(text, value.get_array());
    default: text += json::serialize(value);
  }
}

}  // namespace

std::string to_text(const json::object& object) {
  std::string text;
  append(text, object);
  return text;
}

}  // namespace tmcld

#include "tmcl/json_text.hpp"
#include "tmcl/plain_number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include <boost/json/array.hpp>
#include <boost/json/serialize.hpp>

namespace tmcl {
namespace {

namespace json = boost::json;

bool is_between(char byte, int low, int high) {
  const int value = static_cast<unsigned char>(byte);
  return value >= low && value <= high;
}

/// How many bytes the letter has with which the text begins; 0 if they are none in UTF-8.
std::size_t first_letter(std::string_view text) {
  const char first = text.front();
  if (is_between(first, 0x00, 0x7F)) return 1;
  const std::size_t size = is_between(first, 0xC2, 0xDF)   ? 2
                           : is_between(first, 0xE0, 0xEF) ? 3
                           : is_between(first, 0xF0, 0xF4) ? 4
                                                           : 0;
  if (size == 0 || text.size() < size) return 0;
  // Neither longer than it need be, nor a half of a surrogate pair, nor beyond the last letter.
  const int low = is_between(first, 0xE0, 0xE0)   ? 0xA0
                  : is_between(first, 0xF0, 0xF0) ? 0x90
                                                  : 0x80;
  const int high = is_between(first, 0xED, 0xED)   ? 0x9F
                   : is_between(first, 0xF4, 0xF4) ? 0x8F
                                                   : 0xBF;
  if (!is_between(text[1], low, high)) return 0;
  for (const char byte : text.substr(2, size - 2)) {
    if (!is_between(byte, 0x80, 0xBF)) return 0;
  }
  return size;
}

/// A message may quote a part of a letter, or what an operating system says. The line could
/// not be read then.
std::string as_utf8(std::string_view text) {
  constexpr std::string_view replacement = "\xEF\xBF\xBD";
  std::string readable;
  readable.reserve(text.size());
  while (!text.empty()) {
    const auto size = first_letter(text);
    readable += size == 0 ? replacement : text.substr(0, size);
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return readable;
}

bool stands_for_itself(char byte) {
  return is_between(byte, 0x20, 0x7E) && byte != '"' && byte != '\\';
}

void append(std::string& text, std::string_view words) {
  if (!std::ranges::all_of(words, stands_for_itself)) {
    text += json::serialize(json::string_view(as_utf8(words)));
    return;
  }
  text += '"';
  text += words;
  text += '"';
}

void append_number(std::string& text, auto number) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  text.append(digits.data(), end);
}

void append(std::string& text, const json::array& array) {
  std::string_view separator = "[";
  for (const auto& value : array) {
    text += separator;
    append_json(text, value);
    separator = ",";
  }
  text += array.empty() ? "[]" : "]";
}

}  // namespace

void append_json(std::string& text, const json::value& value) {
  switch (value.kind()) {
    case json::kind::null: text += "null"; return;
    case json::kind::bool_: text += value.get_bool() ? "true" : "false"; return;
    case json::kind::int64: return append_number(text, value.get_int64());
    case json::kind::uint64: return append_number(text, value.get_uint64());
    case json::kind::double_:
      // JSON has no way to write the others.
      text += std::isfinite(value.get_double()) ? plain_number(value.get_double()) : "null";
      return;
    case json::kind::string: {
      const auto& words = value.get_string();
      return append(text, std::string_view(words.data(), words.size()));
    }
    case json::kind::array: return append(text, value.get_array());
    case json::kind::object: return append_json(text, value.get_object());
  }
}

std::string json_text(const json::value& value) {
  std::string text;
  append_json(text, value);
  return text;
}

std::string json_text(const json::object& object) {
  std::string text;
  append_json(text, object);
  return text;
}

void append_json(std::string& text, const json::object& object) {
  std::string_view separator = "{";
  for (const auto& [key, value] : object) {
    text += separator;
    append(text, std::string_view(key.data(), key.size()));
    text += ':';
    append_json(text, value);
    separator = ",";
  }
  text += object.empty() ? "{}" : "}";
}

}  // namespace tmcl

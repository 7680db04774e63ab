#include "api/repeated_name.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/string.hpp>

namespace tmcld {
namespace {

namespace json = boost::json;

std::size_t members_in(const json::value& value) {
  std::size_t count = 0;
  if (const auto* object = value.if_object()) {
    count += object->size();
    for (const auto& [name, member] : *object) count += members_in(member);
  } else if (const auto* array = value.if_array()) {
    for (const auto& element : *array) count += members_in(element);
  }
  return count;
}

/// Behind the string that begins there.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  auto at = begin + 1;
  while (text[at] != '"') at += text[at] == '\\' ? 2U : 1U;
  return at + 1;
}

/// Calls `on_string(begin, end)` for each string and `on_sign(letter)` for whatever else there is.
void scan(std::string_view text, const auto& on_string, const auto& on_sign) {
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '"') {
      const auto end = end_of_string(text, at);
      on_string(at, end);
      at = end;
    } else {
      on_sign(text[at++]);
    }
  }
}

std::size_t members_in(std::string_view text) {
  std::size_t colons = 0;
  scan(
      text, [](std::size_t, std::size_t) {}, [&](char sign) { colons += sign == ':' ? 1U : 0U; });
  return colons;
}

std::optional<std::string> find(std::string_view text) {
  std::vector<std::set<std::string>> levels;
  std::string last;
  std::optional<std::string> repeated;
  const auto on_string = [&](std::size_t begin, std::size_t end) {
    const auto read = json::parse(json::string_view(text.data() + begin, end - begin));
    last.assign(read.get_string().begin(), read.get_string().end());
  };
  const auto on_sign = [&](char sign) {
    if (sign == '{') levels.emplace_back();
    if (sign == '}') levels.pop_back();
    if (sign == ':' && !levels.back().insert(last).second && !repeated) repeated = last;
  };
  scan(text, on_string, on_sign);
  return repeated;
}

}  // namespace

std::optional<std::string> repeated_name(std::string_view text, const json::value& parsed) {
  return members_in(text) == members_in(parsed) ? std::nullopt : find(text);
}

}  // namespace tmcld

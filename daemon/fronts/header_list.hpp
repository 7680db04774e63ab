/// Fields of HTTP that are lists, such as Accept-Encoding.
#pragma once

#include <string_view>

namespace tmcld {

inline std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The first element of a list, which is taken off it.
inline std::string_view take_element(std::string_view& list, char separator = ',') {
  const auto end = list.find(separator);
  const auto element = trimmed(list.substr(0, end));
  list = end == std::string_view::npos ? std::string_view{} : list.substr(end + 1);
  return element;
}

inline bool lists(std::string_view list, std::string_view wanted) {
  while (!list.empty()) {
    if (take_element(list) == wanted) return true;
  }
  return false;
}

}  // namespace tmcld

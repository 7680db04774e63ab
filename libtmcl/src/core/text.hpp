/// Small helpers for names that people type.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace tmcl::text {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

constexpr bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

/// Equal without regard to case, '_', '-' and ' '.
constexpr bool equal_as_name(std::string_view a, std::string_view b) {
  const auto is_filler = [](char c) { return c == '_' || c == '-' || c == ' '; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (true) {
    while (i < a.size() && is_filler(a[i])) ++i;
    while (j < b.size() && is_filler(b[j])) ++j;
    if (i == a.size() || j == b.size()) return i == a.size() && j == b.size();
    if (lower(a[i++]) != lower(b[j++])) return false;
  }
}

/// A whole decimal number that fits; nothing else may stand in the text.
template <class Integer>
std::optional<Integer> parse_integer(std::string_view text) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

inline std::optional<std::uint8_t> parse_byte(std::string_view text) {
  return parse_integer<std::uint8_t>(text);
}

/// The decimal text of a byte, alive for ever.
inline std::string_view byte_name(std::uint8_t value) {
  static const auto names = [] {
    std::array<std::array<char, 4>, 256> all{};
    for (std::size_t i = 0; i < all.size(); ++i) std::to_chars(all[i].data(), all[i].data() + 3, i);
    return all;
  }();
  return names[value].data();
}

}  // namespace tmcl::text

/// A text that is a whole number and nothing else.
#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace tmclsim {

/// Nothing if it is none, or does not fit.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number value = 0;
  const auto* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

}  // namespace tmclsim

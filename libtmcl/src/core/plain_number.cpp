#include "tmcl/plain_number.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace tmcl {
namespace {

constexpr double least_plain = 1e-6;
constexpr double greatest_plain = 1e15;

bool is_plain(double value) {
  return std::abs(value) >= least_plain && std::abs(value) < greatest_plain;
}

template <class... Format>
std::string written(double value, Format... format) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, format...).ptr;
  return {text.data(), end};
}

std::string without_zeros(std::string number) {
  if (number.find('.') == std::string::npos) return number;
  number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  return number;
}

}  // namespace

std::string plain_number(double value) {
  if (value == 0) return "0";  // Never -0.
  if (!std::isfinite(value)) return written(value);
  return written(value, is_plain(value) ? std::chars_format::fixed : std::chars_format::scientific);
}

std::string plain_number(double value, int digits) {
  if (value == 0) return "0";
  if (!is_plain(value)) return written(value, std::chars_format::general, digits);
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  const int decimals = std::max(digits - before_point, 0);
  return without_zeros(written(value, std::chars_format::fixed, decimals));
}

}  // namespace tmcl

#include <algorithm>
#include <span>
#include <string_view>

#include "tmcl/assembler.hpp"

namespace tmcl::program {
namespace {

constexpr std::size_t address_width = 4;
constexpr std::size_t number_width = 5;
// Between address and text: eight bytes with a blank before each.
constexpr std::size_t bytes_width = 3 * instruction_size;

std::string right(std::size_t number, std::size_t width) {
  const auto digits = std::to_string(number);
  return std::string(width - std::min(width, digits.size()), ' ') + digits;
}

std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string text;
  for (const auto byte : bytes) {
    text += ' ';
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

/// A terminal obeys control characters, and a source may hold any.
std::string shown(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == 127; }, '?');
  return text;
}

}  // namespace

std::string listing(const Assembly& assembly) {
  std::string text;
  for (const auto& line : assembly.lines) {
    if (line.address) {
      const auto bytes = to_bytes(std::span(assembly.program).subspan(*line.address, 1));
      text += right(*line.address, address_width) + ' ' + hexadecimal(bytes);
    } else {
      text.append(address_width + 1 + bytes_width, ' ');
    }
    text += ' ' + right(line.line, number_width) + "  " + shown(line.text);
    text.erase(text.find_last_not_of(' ') + 1);
    text += '\n';
  }
  return text;
}

}  // namespace tmcl::program

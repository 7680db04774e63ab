#include "motion/path/text_cursor.hpp"

#include <array>
#include <cstdint>

#include <fmt/format.h>

namespace tmcl::plan {
namespace {

/// The first character of a text in UTF-8; of one byte and no code where it is none.
struct Character {
  std::size_t bytes = 1;
  std::optional<std::uint32_t> code{};
};

Character first_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80) return {1, byte(0)};
  const std::size_t bytes = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = byte(0) & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = code << 6U | (byte(i) & 0x3FU);
  }
  return {bytes, code};
}

std::string shown(const Character& character, char byte) {
  if (!character.code) return fmt::format("\\x{:02X}", static_cast<unsigned char>(byte));
  if (byte == '\t') return "\\t";
  if (byte == '\r') return "\\r";
  if (*character.code < ' ' || *character.code > '~')
    return fmt::format("<U+{:04X}>", *character.code);
  return {byte};
}

}  // namespace

std::string shown(std::string_view word) {
  constexpr std::size_t most_characters = 30;
  std::string text;
  for (std::size_t i = 0; !word.empty(); ++i) {
    if (i == most_characters) return text + "...";
    const auto character = first_character(word);
    text += shown(character, word.front());
    word.remove_prefix(character.bytes);
  }
  return text;
}

std::string_view take_line(std::string_view& text, char end) {
  const auto length = std::min(text.find(end), text.size());
  auto line = text.substr(0, length);
  text.remove_prefix(std::min(length + 1, text.size()));
  while (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::optional<std::string> objection_to_encoding(std::string_view text) {
  // ASCII in UTF-16 or UTF-32 has a zero beside each character, with or without a mark before it.
  constexpr std::array<std::string_view, 2> marks{"\xFF\xFE", "\xFE\xFF"};
  const bool marked = std::ranges::any_of(marks, [&](auto mark) { return text.starts_with(mark); });
  const bool zeros = text.size() >= 2 && (text[0] == '\0') != (text[1] == '\0');
  if (!marked && !zeros) return std::nullopt;
  return "the text is in UTF-16 or UTF-32; save it as UTF-8";
}

}  // namespace tmcl::plan

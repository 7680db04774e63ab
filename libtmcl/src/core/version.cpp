#include "tmcl/version.hpp"

#include <charconv>

#include "core/text.hpp"

namespace tmcl {
namespace {

constexpr std::size_t model_digits = 4;
constexpr std::size_t short_model_digits = 3;

void put_digits(std::span<char> out, unsigned value) {
  for (std::size_t i = out.size(); i-- > 0; value /= 10)
    out[i] = static_cast<char>('0' + value % 10);
}

}  // namespace

std::array<char, version_text_size> to_text(FirmwareVersion version) {
  std::array<char, version_text_size> text{};
  put_digits(std::span(text).first(model_digits), version.model);
  text[model_digits] = version.bootloader ? 'B' : 'V';
  put_digits(std::span(text).subspan(model_digits + 1, 1), version.major);
  put_digits(std::span(text).last(2), version.minor);
  return text;
}

std::optional<FirmwareVersion> version_from_text(std::string_view text) {
  if (text.size() < version_text_size - 1 || text.size() > version_text_size) return std::nullopt;
  const bool dotted = text[short_model_digits + 2] == '.';
  const auto letter_at = dotted ? short_model_digits : model_digits;
  const auto letter = text[letter_at];
  if (letter != 'V' && letter != 'B') return std::nullopt;
  const auto digits = text.substr(dotted ? letter_at + 3 : letter_at + 2);
  const auto model = text::parse_integer<std::uint16_t>(text.substr(0, letter_at));
  const auto major = text::parse_integer<std::uint8_t>(text.substr(letter_at + 1, 1));
  const auto minor = text::parse_integer<std::uint8_t>(digits);
  if (!model || !major || !minor) return std::nullopt;
  const bool cut = digits.size() == 1;
  return FirmwareVersion{*model, *major, static_cast<std::uint8_t>(cut ? *minor * 10 : *minor),
                         letter == 'B'};
}

std::string to_string(FirmwareVersion version) {
  std::array<char, 2> minor{};
  put_digits(minor, version.minor);
  return std::to_string(version.major) + '.' + std::string(minor.begin(), minor.end());
}

}  // namespace tmcl

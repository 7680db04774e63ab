#include "tmcl/hex.hpp"

#include <charconv>

namespace tmcl {

std::string to_hex(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const auto byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 15U];
  }
  return text;
}

tl::expected<std::vector<std::uint8_t>, std::string> from_hex(std::string_view text) {
  if (text.size() % 2 != 0)
    return tl::unexpected(std::string("hexadecimal text has two digits for each byte"));
  std::vector<std::uint8_t> bytes;
  bytes.reserve(text.size() / 2);
  for (; !text.empty(); text.remove_prefix(2)) {
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + 2, byte, 16);
    if (error != std::errc{} || end != text.data() + 2)
      return tl::unexpected("'" + std::string(text.substr(0, 2)) + "' is no hexadecimal byte");
    bytes.push_back(byte);
  }
  return bytes;
}

std::optional<std::int32_t> parse_hexadecimal(std::string_view text) {
  const bool prefixed = text.starts_with("0x") || text.starts_with("0X");
  if (!prefixed && !text.starts_with('$')) return std::nullopt;
  text.remove_prefix(prefixed ? 2 : 1);
  std::uint32_t pattern = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), pattern, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return static_cast<std::int32_t>(pattern);
}

}  // namespace tmcl

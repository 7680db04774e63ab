/// Bytes as text, for JSON; and whole numbers as people write them in hexadecimal.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

namespace tmcl {

/// Two lower-case digits for each byte.
std::string to_hex(std::span<const std::uint8_t> bytes);
/// And back; digits of either case. Errors: what is wrong with the text, in a sentence.
tl::expected<std::vector<std::uint8_t>, std::string> from_hex(std::string_view text);

/// 0x43 or $43, of at most 32 bits, as the assembler reads it: 0xFFFFFFFF is -1. Nothing for what
/// is no such number.
std::optional<std::int32_t> parse_hexadecimal(std::string_view text);

}  // namespace tmcl

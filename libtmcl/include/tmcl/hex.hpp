/// Bytes as text, for JSON.
#pragma once

#include <cstdint>
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

}  // namespace tmcl

/// Secrets that let clients in: of one only its hash is kept.
#pragma once

#include <string>
#include <string_view>

namespace tmcld {

/// 256 random bits, in hexadecimal digits.
std::string new_secret();
/// SHA-256 in hexadecimal digits: so many random bits are not found by trying, so that no salt and
/// no slow hash is needed.
std::string hash_of(std::string_view secret);

}  // namespace tmcld

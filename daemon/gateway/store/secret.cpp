#include "gateway/store/secret.hpp"

#include <array>
#include <span>
#include <stdexcept>

#include <openssl/evp.h>

#include "gateway/store/random_bytes.hpp"

namespace tmcld {
namespace {

constexpr std::size_t secret_bytes = 32;

std::string in_hexadecimal(std::span<const unsigned char> bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const auto byte : bytes) {
    text += digits[byte >> 4U];
    text += digits[byte & 0x0FU];
  }
  return text;
}

}  // namespace

std::string new_secret() {
  std::array<unsigned char, secret_bytes> bytes{};
  fill_with_random_bytes(bytes);
  return in_hexadecimal(bytes);
}

std::string hash_of(std::string_view secret) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
  unsigned size = 0;
  if (EVP_Digest(secret.data(), secret.size(), bytes.data(), &size, EVP_sha256(), nullptr) != 1)
    throw std::runtime_error("SHA-256 cannot be computed");
  return in_hexadecimal(std::span(bytes).first(size));
}

}  // namespace tmcld

#include "broker/random_text.hpp"

#include <array>
#include <stdexcept>
#include <string_view>

#include <sys/random.h>

namespace tmclmqtt {

std::string random_text() {
  // So few the system gives all at once.
  constexpr std::size_t bytes = 16;
  std::array<unsigned char, bytes> drawn{};
  if (::getrandom(drawn.data(), drawn.size(), 0) != static_cast<ssize_t>(drawn.size()))
    throw std::runtime_error("the system gives no random numbers");
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const auto byte : drawn) {
    text += digits[byte >> 4U];
    text += digits[byte & 0xfU];
  }
  return text;
}

}  // namespace tmclmqtt

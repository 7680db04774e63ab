/// Random numbers that cannot be foretold, from the operating system.
#pragma once

#include <cerrno>
#include <cstddef>
#include <span>
#include <stdexcept>

#include <sys/random.h>

namespace tmcld {

/// At most 256 bytes, which the system gives all at once. Throws if it gives none.
inline void fill_with_random_bytes(std::span<unsigned char> bytes) {
  ssize_t count = -1;
  do {
    count = ::getrandom(bytes.data(), bytes.size(), 0);
  } while (count < 0 && errno == EINTR);
  if (count != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system gives no random numbers");
}

}  // namespace tmcld

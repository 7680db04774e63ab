/// A number that stands for everything that happened in a run, and when.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "tmcl/clock.hpp"

namespace tmcld::test {

/// FNV-1a: two runs that differ anywhere have different numbers, as good as always.
class Trace {
 public:
  void add(std::uint64_t number) {
    for (int shift = 0; shift < 64; shift += 8)
      add_byte(static_cast<std::uint8_t>(number >> shift));
  }
  void add(std::string_view text) {
    for (const char character : text) add_byte(static_cast<std::uint8_t>(character));
  }
  void add(tmcl::TimePoint time, std::string_view what, std::span<const std::uint8_t> bytes) {
    add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
    add(what);
    for (const auto byte : bytes) add_byte(byte);
  }
  std::uint64_t value() const { return value_; }

 private:
  void add_byte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001b3U; }

  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace tmcld::test

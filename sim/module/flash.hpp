/// The flash memory that a module's firmware lives in.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tmcl/firmware.hpp"

namespace tmcl::sim {

/// Erased as a whole to 0xFF. Writing only clears bits, as in real flash: what was not erased
/// before does not become what is written.
///
/// Its size is that of a TMCM-1110: two open download tools for that module (stepRocker) take
/// firmware at 0x4000, pages of 512 bytes and an end at 0x40000 for granted. Other models have
/// other sizes; here they all have these.
class Flash {
 public:
  static constexpr std::uint32_t page_size = 512;
  static constexpr std::uint32_t start = 0x4000;  ///< Below it lives the bootloader.
  static constexpr std::uint32_t size = 0x40000;  ///< Also where the addresses end.
  static constexpr std::uint32_t word_size = 4;

  Flash() : bytes_(size - start, firmware::erased_byte) {}

  static bool contains(std::uint32_t address) { return address >= start && address < size; }

  void erase() { std::ranges::fill(bytes_, firmware::erased_byte); }
  /// All of it must be in the memory.
  void write(std::uint32_t address, std::span<const std::uint8_t> data) {
    auto byte = bytes_.begin() + (address - start);
    for (const auto written : data) {
      *byte = static_cast<std::uint8_t>(*byte & written);
      ++byte;
    }
  }
  std::span<const std::uint8_t> read(std::uint32_t address, std::size_t count) const {
    return std::span(bytes_).subspan(address - start, count);
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace tmcl::sim

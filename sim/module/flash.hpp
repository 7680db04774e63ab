/// The flash memory that a module's firmware lives in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
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

  static bool contains(std::uint32_t address) { return address >= start && address < size; }

  void erase() { pages_.clear(); }
  /// All of it must be in the memory.
  void write(std::uint32_t address, std::span<const std::uint8_t> data) {
    for (const auto byte : data) {
      auto& page = pages_.try_emplace(address / page_size, erased_page).first->second;
      auto& cell = page[address++ % page_size];
      cell = static_cast<std::uint8_t>(cell & byte);
    }
  }
  std::vector<std::uint8_t> read(std::uint32_t address, std::size_t count) const {
    std::vector<std::uint8_t> bytes(count);
    for (auto& byte : bytes) byte = at(address++);
    return bytes;
  }

 private:
  using Page = std::array<std::uint8_t, page_size>;
  static constexpr Page erased_page = [] {
    Page page{};
    page.fill(firmware::erased_byte);
    return page;
  }();

  std::uint8_t at(std::uint32_t address) const {
    const auto page = pages_.find(address / page_size);
    return page == pages_.end() ? firmware::erased_byte : page->second[address % page_size];
  }

  std::map<std::uint32_t, Page> pages_;  ///< Those that are not empty.
};

}  // namespace tmcl::sim

/// Writes what the library reads: Intel HEX files.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl::test {

inline std::string hex_record(std::uint8_t type, std::uint16_t offset,
                              std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(data.size()),
                                  static_cast<std::uint8_t>(offset >> 8U),
                                  static_cast<std::uint8_t>(offset & 0xFFU), type};
  bytes.insert(bytes.end(), data.begin(), data.end());
  std::uint8_t sum = 0;
  for (const auto byte : bytes) sum = static_cast<std::uint8_t>(sum - byte);
  bytes.push_back(sum);
  std::string text = ":";
  for (const auto byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02X", byte);
    text += digits;
  }
  return text + '\n';
}

inline std::string hex_base(std::uint32_t address) {
  const std::uint8_t high[] = {static_cast<std::uint8_t>(address >> 24U),
                               static_cast<std::uint8_t>(address >> 16U & 0xFFU)};
  return hex_record(4, 0, high);
}

inline const std::string hex_end = ":00000001FF\n";

/// A whole file, with 16 bytes a record.
inline std::string hex_file(std::uint32_t start, std::span<const std::uint8_t> bytes) {
  std::string text;
  std::uint32_t base = 1;
  for (std::size_t at = 0; at < bytes.size();) {
    const auto address = start + static_cast<std::uint32_t>(at);
    if ((address & 0xFFFF0000U) != base) {
      base = address & 0xFFFF0000U;
      text += hex_base(base);
    }
    const auto count =
        std::min<std::size_t>({16, bytes.size() - at, 0x10000 - (address & 0xFFFFU)});
    text += hex_record(0, static_cast<std::uint16_t>(address & 0xFFFFU), bytes.subspan(at, count));
    at += count;
  }
  return text + hex_end;
}

/// Bytes that look like a program, with this version somewhere among them.
inline std::vector<std::uint8_t> firmware_bytes(std::size_t size, std::string_view version,
                                                std::uint8_t salt = 0) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    // Above the letters and digits: no version by chance.
    bytes[i] = static_cast<std::uint8_t>(0x80U | ((i * 7 + i / 256 + salt) & 0x7FU));
  }
  std::ranges::copy(version, bytes.begin() + static_cast<std::ptrdiff_t>(size / 2));
  return bytes;
}

}  // namespace tmcl::test

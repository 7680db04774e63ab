/// The numbers of the commands that talk to a module's bootloader.
#pragma once

#include <cstdint>

namespace tmcl::bootloader {

/// What ENTER_BOOTLOADER must have with it to leave the firmware.
constexpr std::uint8_t entry_type = 0x81;
constexpr std::uint8_t entry_motor = 0x92;
constexpr std::uint32_t entry_value = 0xA3B4C5D6;

/// The types of BOOT_GET_INFO.
enum class Info : std::uint8_t { page_size = 0, start = 1, size = 2 };
/// Of BOOT_WRITE_LENGTH: what makes a firmware whole.
enum class Seal : std::uint8_t { length = 0, checksum = 1 };

}  // namespace tmcl::bootloader

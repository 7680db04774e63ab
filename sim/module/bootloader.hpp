/// What a module runs while its firmware is exchanged.
#pragma once

#include <array>
#include <cstdint>

#include "sim/module/answer.hpp"
#include "sim/module/flash.hpp"
#include "tmcl/datagram.hpp"
#include "tmcl/version.hpp"

namespace tmcl::sim {

/// Whether this is the command that leaves the firmware for the bootloader, magic numbers included.
Status check_bootloader_entry(const Request& request);

/// Knows the commands 200..208 and tells its version as text ("1110B101") and as number; everything
/// else is an invalid command. The commands and their fields are those that PyTrinamic's
/// tmclfwupload and the older tools for the stepRocker use:
///
///     200  erases everything                        201  type + 256 * motor: word of the page
///     202  value: address within the page to write       buffer, least significant byte first
///     203  value: last address; the sum from the    204  value: address of a word
///          first                                    206  type 0 page size, 1 start, 2 size
///     205  starts the firmware, if there is one     208  type 0 length, 1 checksum
///
/// Length and checksum stand in the last two words of the memory: older tools write that page
/// instead of using command 208. What no source tells: out of range is invalid_value, and the page
/// buffer is empty (0xFF) after each page, so that a host that writes a page again must fill it
/// again.
class Bootloader {
 public:
  /// With the firmware that the module came with.
  Bootloader(std::uint16_t model, FirmwareVersion firmware);

  /// BOOT_START_APPLICATION has no answer; whether it can be obeyed is has_firmware().
  Answer execute(const Request& request);

  /// A firmware whose length and checksum fit.
  bool has_firmware() const;
  /// As it stands in the firmware; `otherwise` if it says none for this model.
  FirmwareVersion firmware_version(FirmwareVersion otherwise) const;
  FirmwareVersion version() const { return {model_, 1, 1, true}; }

 private:
  static constexpr std::uint32_t length_address = Flash::size - 2 * Flash::word_size;
  static constexpr std::uint32_t checksum_address = Flash::size - Flash::word_size;

  Answer tell_version(const Request& request) const;
  Answer erase(const Request& request);
  Answer fill_buffer(const Request& request);
  Answer write_page(const Request& request);
  Answer tell_checksum(const Request& request) const;
  Answer read_memory(const Request& request) const;
  Answer tell_info(const Request& request) const;
  Answer write_length(const Request& request);

  void clear_buffer() { buffer_.fill(firmware::erased_byte); }
  void write_word(std::uint32_t address, std::uint32_t word);
  std::uint32_t word_at(std::uint32_t address) const;
  std::uint32_t sum_to(std::uint32_t last) const;

  std::uint16_t model_;
  Flash flash_;
  std::array<std::uint8_t, Flash::page_size> buffer_{};
};

}  // namespace tmcl::sim

/// The status byte of a TMCL reply.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace tmcl {

enum class Status : std::uint8_t {
  wrong_checksum = 1,
  invalid_command = 2,
  wrong_type = 3,
  invalid_value = 4,
  eeprom_locked = 5,
  command_not_available = 6,
  load_error = 7,
  write_protected = 8,
  maximum_exceeded = 9,
  download_not_possible = 10,
  chip_read_failed = 11,
  avr_not_ready = 32,
  ok = 100,
  command_loaded = 101,
  delayed = 128,  ///< Only in the event that follows TARGET_REACHED_EVENT.
  active_communication = 129,
};

struct StatusInfo {
  Status status;
  std::string_view name;     ///< snake_case; part of the stable interface.
  std::string_view meaning;  ///< What happened, for a person.
  std::string_view hint;     ///< What to try; empty when the command succeeded.
};

/// Every status, ascending by number.
std::span<const StatusInfo> status_table();
/// Null for a number that no manual lists.
const StatusInfo* find_status(Status status);
/// The standard name, or "unknown_status".
std::string_view name_of(Status status);

/// Whether the module executed (or, in download mode, stored) the command.
constexpr bool is_success(Status status) { return static_cast<std::uint8_t>(status) >= 100; }

}  // namespace tmcl

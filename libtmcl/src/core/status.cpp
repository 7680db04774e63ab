#include "tmcl/status.hpp"

#include <algorithm>
#include <array>

namespace tmcl {
namespace {

constexpr auto statuses = std::to_array<StatusInfo>({
    {Status::wrong_checksum, "wrong_checksum",
     "the module received the request with a wrong checksum",
     "look for noise, a wrong baud rate or two programs on one line"},
    {Status::invalid_command, "invalid_command", "the module does not know this command",
     "see the firmware manual of the model for the commands it has"},
    {Status::wrong_type, "wrong_type", "the module does not know this type or parameter number",
     "'tmclctl params AXIS' lists the parameters; see also the firmware manual of the model"},
    {Status::invalid_value, "invalid_value",
     "the value, motor or bank is outside what the module allows",
     "check the parameter's range and how many motors the module has"},
    {Status::eeprom_locked, "eeprom_locked", "the configuration EEPROM is locked",
     "unlock it with SGP 73, 0, 4321"},
    {Status::command_not_available, "command_not_available", "the command is not available now",
     "a running program, or the module's state, may forbid it"},
    {Status::load_error, "load_error", "loading failed", "try again; check the stored data"},
    {Status::write_protected, "write_protected", "the parameter or program is write protected",
     "see global parameter 81 (code protection)"},
    {Status::maximum_exceeded, "maximum_exceeded", "a maximum number is exceeded",
     "remove one before adding another"},
    {Status::download_not_possible, "download_not_possible", "a program cannot be downloaded now",
     "stop the running program first"},
    {Status::chip_read_failed, "chip_read_failed", "the module could not read one of its chips",
     "check the module's supply voltage"},
    {Status::avr_not_ready, "avr_not_ready", "the module is not ready yet",
     "wait a little and try again"},
    {Status::ok, "ok", "executed", ""},
    {Status::command_loaded, "command_loaded", "loaded into program memory", ""},
    {Status::delayed, "delayed", "reported later, as asked", ""},
    {Status::active_communication, "active_communication", "active communication", ""},
});

static_assert(std::ranges::is_sorted(statuses, {}, &StatusInfo::status));

}  // namespace

std::span<const StatusInfo> status_table() { return statuses; }

const StatusInfo* find_status(Status status) {
  const auto* row = std::ranges::lower_bound(statuses, status, {}, &StatusInfo::status);
  return row != statuses.end() && row->status == status ? row : nullptr;
}

std::string_view name_of(Status status) {
  const auto* row = find_status(status);
  return row != nullptr ? row->name : "unknown_status";
}

}  // namespace tmcl

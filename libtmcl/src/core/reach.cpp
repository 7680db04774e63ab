#include "tmcl/reach.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include "tmcl/parameter.hpp"

namespace tmcl {
namespace {

namespace gp = global_parameter;

enum class On : std::uint8_t { every_link, serial, can };

bool is_on(On on, Framing framing) {
  return on == On::every_link || (on == On::serial) == (framing == Framing::serial);
}

struct LosingCommand {
  Command command;
  std::string_view why;
};

constexpr auto losing_commands = std::to_array<LosingCommand>({
    {Command::FACTORY_RESET, "goes back to the address and the rates that it was delivered with"},
    {Command::ENTER_ASCII_MODE, "understands nothing but lines of text then"},
    {Command::ENTER_BOOTLOADER, "runs no firmware then that could move or stop anything"},
});

/// Whether the module is still reached with this value.
using Keeps = bool (*)(const Request& request, const Reach& reach);

struct LosingParameter {
  std::uint8_t number;  ///< In bank 0.
  On on;
  Keeps keeps;
  std::string_view why;
};

constexpr std::uint8_t interface_selection = 88;
constexpr std::int32_t untouched_eeprom = 228;
constexpr std::int32_t starts_in_ascii_mode = 1;

bool never(const Request&, const Reach&) { return false; }
bool has_its_address(const Request& request, const Reach&) {
  return request.value == number(request.address);
}

// From the firmware manuals; the numbers are those of the table of global parameters.
constexpr auto losing_parameters = std::to_array<LosingParameter>({
    {gp::eeprom_magic, On::every_link,
     [](const Request& request, const Reach&) { return request.value == untouched_eeprom; },
     "goes back to the address and the rates that it was delivered with when it starts next"},
    {gp::serial_baud_rate, On::serial, never, "speaks at another rate than the bus then"},
    {gp::serial_address, On::serial, has_its_address, "has another address then"},
    {gp::ascii_mode, On::every_link,
     [](const Request& request, const Reach&) {
       return (request.value & starts_in_ascii_mode) == 0;
     },
     "understands nothing but lines of text when it starts next"},
    {gp::can_bit_rate, On::can, never, "speaks at another rate than the bus then"},
    {gp::can_reply_id, On::can,
     [](const Request& request, const Reach& reach) {
       return request.value == static_cast<std::int32_t>(reach.can_reply_id);
     },
     "answers with an identifier that the bus does not listen to"},
    {gp::can_id, On::can, has_its_address, "has another address then"},
    {gp::telegram_pause_time, On::serial,
     [](const Request& request, const Reach& reach) {
       return std::chrono::milliseconds(request.value) <= reach.longest_pause;
     },
     "answers later than the bus waits"},
    {gp::serial_host_address, On::serial,
     [](const Request& request, const Reach& reach) { return request.value == reach.host_address; },
     "answers to another host address than that of the bus"},
    {interface_selection, On::every_link, never, "may listen to another interface then"},
    {gp::suppress_reply, On::every_link,
     [](const Request& request, const Reach&) { return request.value == 0; },
     "answers no command that sets something, nor a stop"},
});

/// What takes the value from where no host sees it, an accumulator or the EEPROM, can set any.
std::optional<std::string_view> loss_by_parameter(const Request& request, const Reach& reach) {
  constexpr std::uint8_t bank_of_parameters = 0;
  const bool is_seen = request.command == Command::SGP;
  const bool sets = is_seen || request.command == Command::AGP || request.command == Command::RSGP;
  if (!sets || request.motor != bank_of_parameters) return std::nullopt;
  const auto* row = std::ranges::find(losing_parameters, request.type, &LosingParameter::number);
  if (row == losing_parameters.end() || !is_on(row->on, reach.framing)) return std::nullopt;
  if (is_seen && row->keeps(request, reach)) return std::nullopt;
  return row->why;
}

}  // namespace

std::optional<std::string_view> loss_of_reach(const Request& request, const Reach& reach) {
  const auto* row = std::ranges::find(losing_commands, request.command, &LosingCommand::command);
  if (row != losing_commands.end()) return row->why;
  return loss_by_parameter(request, reach);
}

}  // namespace tmcl

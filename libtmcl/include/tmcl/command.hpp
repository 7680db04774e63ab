/// The commands of TMCL: their numbers, their standard names, and what a host must know before it
/// sends one.
///
/// One table (command_table) is the only place where this is written down. Numbers and names are
/// those of the TMCL firmware manuals and of the vendor's own host libraries.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "tmcl/intent.hpp"

namespace tmcl {

// clang-format off
enum class Command : std::uint8_t {
  ROR = 1, ROL = 2, MST = 3, MVP = 4, SAP = 5, GAP = 6, STAP = 7, RSAP = 8, SGP = 9, GGP = 10, STGP = 11, RSGP = 12,
  RFS = 13, SIO = 14, GIO = 15, CALC = 19, COMP = 20, JC = 21, JA = 22, CSUB = 23, RSUB = 24, EI = 25, DI = 26,
  WAIT = 27, STOP = 28, SAC = 29, SCO = 30, GCO = 31, CCO = 32, CALCX = 33, AAP = 34, AGP = 35, CLE = 36, VECT = 37,
  RETI = 38, ACO = 39, CALCVV = 40, CALCVA = 41, CALCAV = 42, CALCVX = 43, CALCXV = 44, CALCV = 45, MVPA = 46,
  RST = 48, DJNZ = 49, ROLA = 50, RORA = 51, SIV = 55, GIV = 56, AIV = 57,
  UF0 = 64, UF1 = 65, UF2 = 66, UF3 = 67, UF4 = 68, UF5 = 69, UF6 = 70, UF7 = 71, CALL = 80,
  STOP_APPLICATION = 128, RUN_APPLICATION = 129, STEP_APPLICATION = 130, RESET_APPLICATION = 131,
  START_DOWNLOAD = 132, END_DOWNLOAD = 133, READ_TMCL_MEMORY = 134, GET_APPLICATION_STATUS = 135,
  GET_FIRMWARE_VERSION = 136, FACTORY_RESET = 137, TARGET_REACHED_EVENT = 138, ENTER_ASCII_MODE = 139,
  SECURITY_CODE = 140, BREAKPOINT = 141, RAM_DEBUG = 142, GET_IDS = 143, WRITE_USER_CHANNEL = 144,
  READ_USER_CHANNEL = 145, WRITE_MC = 146, WRITE_DRV = 147, READ_MC = 148, READ_DRV = 149, MEASURED_SPEED = 150,
  BOARD_ERROR = 151, BOARD_RESET = 152, GET_INFO = 157, WLAN0 = 160, WLAN1 = 161, WLAN2 = 162, WLAN3 = 163,
  GET_AP_MIN = 170, GET_AP_MAX = 171, OTP = 172, BOOT_ERASE_ALL = 200, BOOT_WRITE_BUFFER = 201,
  BOOT_WRITE_PAGE = 202, BOOT_GET_CHECKSUM = 203, BOOT_READ_MEMORY = 204, BOOT_START_APPLICATION = 205,
  BOOT_GET_INFO = 206, BOOT_WRITE_LENGTH = 208, ENTER_BOOTLOADER = 242, SOFTWARE_RESET = 255,
};
// clang-format on

/// What comes back after a command.
enum class ReplyKind : std::uint8_t {
  normal,   ///< One reply in the ordinary form.
  version,  ///< Ordinary reply or, for type 0, nine bytes of text with neither status nor checksum.
  then_event,  ///< One reply now, and an event (status 128) later.
  memory,      ///< A line of the program: see memory_reply() in tmcl/program.hpp.
  none,        ///< Nothing: the command counts as done once it is on the wire.
};

/// Whether a command may be sent again when it is unknown if it was executed.
enum class Repeat : std::uint8_t {
  safe,   ///< Executing it twice leaves the module as executing it once does, and moves nothing
          ///< anew.
  never,  ///< Could move a motor again, wear the EEPROM, toggle an output or advance a program.
};

/// The field of a command that an operand fills when the command is written as text.
enum class Field : std::uint8_t {
  type,     ///< 0..255, or the type's standard name.
  motor,    ///< 0..255: motor, bank or user variable.
  value,    ///< 32 bits.
  address,  ///< The value as well: the number of a command of the program.
};

struct Operand {
  Field field;
  std::string_view name;  ///< What the firmware manuals call it, such as "motor" or "bank".
  bool optional = false;  ///< May be left out with all that follow it, and is 0 then.
};

struct CommandInfo {
  Command command;
  std::string_view name;  ///< Standard mnemonic, upper case.
  ReplyKind reply;
  Repeat repeat;
  Intent intent;
  std::string_view meaning;
  /// What follows the mnemonic in the text of a stand-alone program; nothing for a command that has
  /// no place in one.
  std::optional<std::span<const Operand>> operands{};
};

/// A value of the type field that has a standard name or behaves differently from its command's
/// row.
struct SubtypeInfo {
  Command command;
  std::uint8_t type;
  std::string_view
      name;  ///< Standard name, upper case; empty where the type is a parameter's number.
  Repeat repeat;
  Intent intent;
};

/// Every command, ascending by number.
std::span<const CommandInfo> command_table();
/// Every named type, grouped by command.
std::span<const SubtypeInfo> subtype_table();

/// The row of a command; null for a number that TMCL does not define.
const CommandInfo* find_command(std::uint8_t number);
/// Looks a command up by mnemonic, upper or lower case, or by decimal number 0..255 (also an
/// undefined one).
std::optional<Command> parse_command(std::string_view text);
/// Looks a type up by its standard name within a command, or by decimal number 0..255.
std::optional<std::uint8_t> parse_subtype(Command command, std::string_view text);
/// The mnemonic, or the number as text for a command that TMCL does not define.
std::string_view name_of(Command command);
/// The standard name of a type; empty if it has none.
std::string_view name_of_subtype(Command command, std::uint8_t type);

/// A command that TMCL does not define is taken to move motors and is never repeated.
ReplyKind reply_kind(Command command);
Repeat repeat_rule(Command command, std::uint8_t type);
/// As the table has it, for any value. See also intent_of() in tmcl/intent.hpp.
const Intent& intent_of(Command command, std::uint8_t type);
inline Effect effect_of(Command command, std::uint8_t type) {
  return intent_of(command, type).effect;
}

}  // namespace tmcl

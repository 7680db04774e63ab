/// The ASCII mode of a module: commands as a person types them into a terminal.
///
/// A line begins with the letter of the module's address, A for 1, B for 2 and so on; blanks; a
/// command as the TMCL-IDE writes it; and ends with a carriage return, which is not part of it
/// here. The module answers with the letters of the host's address and of its own, status and
/// value:
///
///     AMVP ABS, 0, 50000              BA 100 50000
///     a gap 1, 0                      BA 100 -5000
///
/// This, and which commands there are, is from the manuals of TMCM-6110 and TMCM-1140: those of
/// direct mode from ROR to CCO, the user functions, and BIN, RUN and STOP. They do not tell about
/// case, which does not matter here; nor what a module above address 26, for which there is no
/// letter, does: here it cannot be reached in ASCII mode.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <tl/expected.hpp>

#include "tmcl/datagram.hpp"

namespace tmcl::ascii {

constexpr std::size_t longest_line = 80;  ///< Characters, without the carriage return.
constexpr std::uint8_t greatest_address = 26;

/// Back to datagrams (BIN).
struct Leave {
  ModuleAddress address{1};
  auto operator<=>(const Leave&) const = default;
};
/// RUN and STOP come as the commands RUN_APPLICATION (continue) and STOP_APPLICATION.
using Order = std::variant<Request, Leave>;

struct Fault {
  std::size_t column = 0;  ///< From 1.
  std::string message;     ///< Without a full stop, unless a question or suggestion follows.
  /// What a module answers: invalid_command for an unknown one or a line without sense, wrong_type
  /// for an unknown name of a type, invalid_value for operands out of range or too many.
  Status status = Status::invalid_command;
};

/// 'A' for 1 up to 'Z' for 26; none for other addresses.
std::optional<char> letter_of(std::uint8_t address);
/// Of the module that a line is for, however it goes on; none if it begins with no letter.
std::optional<ModuleAddress> address_of(std::string_view line);

/// What the line says. Numbers are decimal; types may have their standard names. Operands that are
/// left out at the end are 0.
tl::expected<Order, Fault> parse(std::string_view line);

/// The line for a command; none if it cannot be given in ASCII mode or the address has no letter.
/// Only the fields that the command's operands fill are said.
std::optional<std::string> to_line(const Order& order);

/// "BA 100 50000". An address without a letter becomes '?'. The command is not said.
std::string to_text(const Reply& reply);
/// The way back; the command is left 0.
std::optional<Reply> parse_reply(std::string_view text);

}  // namespace tmcl::ascii

#include "tmcl/ascii.hpp"

#include <span>
#include <vector>

#include "core/text.hpp"
#include "program/cursor.hpp"
#include "program/encoding.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl::ascii {
namespace {

using program::Cursor;
using program::Instruction;

constexpr std::string_view leave_word = "BIN";
constexpr std::string_view run_word = "RUN";
constexpr std::string_view stop_word = "STOP";

constexpr bool is_letter(char c) { return text::lower(c) >= 'a' && text::lower(c) <= 'z'; }

constexpr bool is_direct(Command command) {
  const auto number = static_cast<std::uint8_t>(command);
  const auto between = [&](Command first, Command last) {
    return number >= static_cast<std::uint8_t>(first) && number <= static_cast<std::uint8_t>(last);
  };
  return between(Command::ROR, Command::GIO) || between(Command::SCO, Command::CCO) ||
         between(Command::UF0, Command::UF7);
}

tl::unexpected<Fault> fault(const Cursor& where, std::string message, Status status) {
  return tl::unexpected(Fault{where.at() + 1, std::move(message), status});
}

const CommandInfo* find_direct(std::string_view mnemonic) {
  for (const auto& row : command_table()) {
    if (is_direct(row.command) && text::equal_ignoring_case(row.name, mnemonic)) return &row;
  }
  return nullptr;
}

std::string unknown_command(std::string_view mnemonic) {
  std::vector<std::string_view> names{leave_word, run_word, stop_word};
  for (const auto& row : command_table()) {
    if (is_direct(row.command)) names.push_back(row.name);
  }
  auto message = "there is no command '" + program::printable(mnemonic) + "' in ASCII mode";
  const auto question = did_you_mean(mnemonic, names);
  return question.empty() ? message : message + '.' + question;
}

template <class Integer>
std::optional<std::int64_t> number_in(std::string_view written) {
  const auto value = text::parse_integer<Integer>(written);
  return value ? std::optional<std::int64_t>(*value) : std::nullopt;
}

std::optional<std::int64_t> value_of(Command command, const Operand& operand,
                                     std::string_view written) {
  switch (operand.field) {
    case Field::type: return parse_subtype(command, written);
    case Field::motor: return number_in<std::uint8_t>(written);
    case Field::value:
    case Field::address: return number_in<std::int32_t>(written);
  }
  return std::nullopt;
}

constexpr bool is_in_operand(char c) { return program::is_in_name(c) || c == '-'; }

/// Reads operands until the line ends. What is left out at the end is 0: a driver of the PD-1161
/// (nalt/trinamic_stepper) says MST without a motor. The manuals are silent about that.
tl::expected<Instruction, Fault> read_operands(Cursor cursor, const CommandInfo& row) {
  const auto operands = *row.operands;
  Instruction instruction{row.command};
  std::size_t count = 0;
  cursor.skip_blanks();
  while (!cursor.at_end()) {
    if (count == operands.size()) {
      return fault(cursor, std::string(row.name) + " takes no more than this",
                   Status::invalid_value);
    }
    const auto& operand = operands[count];
    const auto where = cursor;
    const auto written = cursor.take_while(is_in_operand);
    const auto value = value_of(row.command, operand, written);
    if (!value) {
      const bool named =
          operand.field == Field::type && !where.at_end() && program::begins_name(where.peek());
      return fault(where, "'" + where.word() + "' is no " + std::string(operand.name),
                   named ? Status::wrong_type : Status::invalid_value);
    }
    program::set_field(instruction, operand.field, *value);
    ++count;
    cursor.skip_blanks();
    if (cursor.at_end()) break;
    if (!cursor.take(',')) return fault(cursor, "a comma is missing", Status::invalid_value);
    cursor.skip_blanks();
    if (cursor.at_end()) return fault(cursor, "nothing follows the comma", Status::invalid_value);
  }
  return instruction;
}

tl::expected<Order, Fault> alone(const Cursor& rest, std::string_view word, Order order) {
  auto cursor = rest;
  cursor.skip_blanks();
  if (cursor.at_end()) return order;
  return fault(cursor, std::string(word) + " stands alone", Status::invalid_value);
}

void append_number(std::string& line, std::int64_t value) { line += std::to_string(value); }

}  // namespace

std::optional<char> letter_of(std::uint8_t address) {
  if (address < 1 || address > greatest_address) return std::nullopt;
  return static_cast<char>('A' + address - 1);
}

std::optional<ModuleAddress> address_of(std::string_view line) {
  if (line.empty() || !is_letter(line.front())) return std::nullopt;
  return ModuleAddress{static_cast<std::uint16_t>(text::lower(line.front()) - 'a' + 1)};
}

tl::expected<Order, Fault> parse(std::string_view line) {
  Cursor cursor(line);
  if (line.size() > longest_line) {
    return fault(cursor, "a line has at most " + std::to_string(longest_line) + " characters",
                 Status::invalid_command);
  }
  const auto address = address_of(line);
  if (!address) {
    return fault(cursor, "a line begins with the letter of an address, A to Z",
                 Status::invalid_command);
  }
  cursor.skip();
  cursor.skip_blanks();
  const auto where = cursor;
  const auto mnemonic = cursor.take_while(program::is_in_name);
  const auto is = [&](std::string_view word) { return text::equal_ignoring_case(mnemonic, word); };
  if (is(leave_word)) return alone(cursor, leave_word, Leave{*address});
  if (is(run_word)) return alone(cursor, run_word, Request{*address, Command::RUN_APPLICATION});
  if (is(stop_word)) return alone(cursor, stop_word, Request{*address, Command::STOP_APPLICATION});
  const auto* row = find_direct(mnemonic);
  if (row == nullptr) return fault(where, unknown_command(mnemonic), Status::invalid_command);
  return read_operands(cursor, *row).map([&](const Instruction& instruction) {
    return Order{Request{*address, instruction.command, instruction.type, instruction.motor,
                         instruction.value}};
  });
}

std::optional<std::string> to_line(const Order& order) {
  const auto address = std::visit([](const auto& one) { return reply_byte(one.address); }, order);
  const auto letter = letter_of(address);
  if (!letter) return std::nullopt;
  std::string line(1, *letter);
  const auto* request = std::get_if<Request>(&order);
  if (request == nullptr) return line.append(leave_word);
  if (request->command == Command::STOP_APPLICATION) return line.append(stop_word);
  if (request->command == Command::RUN_APPLICATION && request->type == 0)
    return line.append(run_word);
  if (!is_direct(request->command)) return std::nullopt;
  const auto* row = find_command(static_cast<std::uint8_t>(request->command));
  line.append(row->name);
  const Instruction instruction{request->command, request->type, request->motor, request->value};
  std::string_view between = " ";
  for (const auto& operand : *row->operands) {
    line.append(between);
    between = ", ";
    const auto name = operand.field == Field::type
                          ? name_of_subtype(request->command, request->type)
                          : std::string_view{};
    if (name.empty()) {
      append_number(line, program::get_field(instruction, operand.field));
    } else {
      line.append(name);
    }
  }
  return line;
}

std::string to_text(const Reply& reply) {
  std::string text{letter_of(reply.host).value_or('?'), letter_of(reply.module).value_or('?'), ' '};
  append_number(text, static_cast<int>(reply.status));
  text += ' ';
  append_number(text, reply.value);
  return text;
}

std::optional<Reply> parse_reply(std::string_view text) {
  if (text.size() < 2) return std::nullopt;
  const auto host = address_of(text.substr(0, 1));
  const auto module = address_of(text.substr(1, 1));
  Cursor cursor(text.substr(2));
  cursor.skip_blanks();
  const auto status = text::parse_byte(cursor.take_while(program::is_digit));
  cursor.skip_blanks();
  const auto value = text::parse_integer<std::int32_t>(cursor.take_rest());
  if (!host || !module || !status || !value) return std::nullopt;
  return Reply{reply_byte(*host), reply_byte(*module), static_cast<Status>(*status), Command{},
               *value};
}

}  // namespace tmcl::ascii

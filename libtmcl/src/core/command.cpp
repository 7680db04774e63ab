#include "tmcl/command.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/text.hpp"
#include "tmcl/command_type.hpp"
#include "tmcl/hex.hpp"

namespace tmcl {
namespace {

using enum ReplyKind;
constexpr auto safe = Repeat::safe;
constexpr auto never = Repeat::never;

// ---- what commands can do ----------------------------------------------------------------------

constexpr Intent intent(Effect effect, Motion motion, Subject subject) {
  return {effect, motion, subject, Setpoint::none, false, false};
}
constexpr Intent sets(Setpoint setpoint, Intent it) {
  it.sets = setpoint;
  return it;
}
/// The value comes from the accumulator, from the EEPROM, or goes past the firmware.
constexpr Intent unseen(Intent it) {
  it.is_unseen = true;
  return it;
}
constexpr Intent with_coordinates(Intent it) {
  it.changes_coordinates = true;
  return it;
}

constexpr auto reads = intent(Effect::reads, Motion::unchanged, Subject::module);
constexpr auto writes = intent(Effect::writes, Motion::unchanged, Subject::module);
constexpr auto writes_motor = intent(Effect::writes, Motion::unchanged, Subject::motor);
constexpr auto writes_output = intent(Effect::writes, Motion::unchanged, Subject::output);
constexpr auto writes_coordinate = with_coordinates(writes_motor);
/// A global parameter can be a coordinate.
constexpr auto writes_global = with_coordinates(writes);
constexpr auto stops = intent(Effect::stops, Motion::stops, Subject::motor);
constexpr auto turns =
    sets(Setpoint::velocity, intent(Effect::moves, Motion::turns, Subject::motor));
constexpr auto moves_to =
    sets(Setpoint::position, intent(Effect::moves, Motion::to_position, Subject::motor));
constexpr auto moves_by = intent(Effect::moves, Motion::by_distance, Subject::motor);
/// Of which motors, its motor field says.
constexpr auto moves_to_coordinate = intent(Effect::moves, Motion::to_position, Subject::several);
/// To a position that its value does not name.
constexpr auto moves_elsewhere = intent(Effect::moves, Motion::to_position, Subject::motor);
constexpr auto writes_target =
    sets(Setpoint::position, intent(Effect::moves, Motion::to_target, Subject::motor));
constexpr auto writes_position =
    sets(Setpoint::here, intent(Effect::moves, Motion::unchanged, Subject::motor));
constexpr auto writes_mode =
    sets(Setpoint::mode, intent(Effect::moves, Motion::turns, Subject::motor));
/// A parameter that makes the motor of some model turn.
constexpr auto may_turn = intent(Effect::moves, Motion::turns, Subject::motor);
/// Which parameter it is, its type says.
constexpr auto writes_unseen = unseen(intent(Effect::moves, Motion::unchanged, Subject::motor));
constexpr auto writes_register = unseen(intent(Effect::moves, Motion::turns, Subject::chip));
constexpr auto unforeseen_of_motor = intent(Effect::moves, Motion::unforeseen, Subject::motor);
constexpr auto ends_search = intent(Effect::stops, Motion::unchanged, Subject::motor);
constexpr auto searches = intent(Effect::moves, Motion::searches, Subject::motor);
constexpr auto runs_program =
    with_coordinates(intent(Effect::moves, Motion::by_program, Subject::module));
constexpr auto ends_program = intent(Effect::writes, Motion::ends_program, Subject::module);
constexpr auto restarts =
    with_coordinates(intent(Effect::moves, Motion::restarts, Subject::module));
constexpr auto boot_writes =
    with_coordinates(intent(Effect::writes, Motion::restarts, Subject::module));
/// What that is, the firmware of a customer or a board says.
constexpr auto acts_as_built =
    with_coordinates(intent(Effect::moves, Motion::unforeseen, Subject::module));
constexpr Intent unforeseen{};

// clang-format off
// How commands are written in programs, as the TMCM-1290 firmware manual has it. It does not have
// SAC, STAP and RSAP any more: the first is written with all three fields, the others like GAP.
constexpr std::span<const Operand> alone{};
constexpr Operand motor_velocity[] = {{Field::motor, "motor"}, {Field::value, "velocity"}};
constexpr Operand one_motor[] = {{Field::motor, "motor"}};
constexpr Operand type_motor_position[] = {
    {Field::type, "type"}, {Field::motor, "motor"}, {Field::value, "position"}};
constexpr Operand parameter_motor_value[] = {
    {Field::type, "parameter"}, {Field::motor, "motor"}, {Field::value, "value"}};
constexpr Operand parameter_motor[] = {{Field::type, "parameter"}, {Field::motor, "motor"}};
constexpr Operand parameter_bank_value[] = {
    {Field::type, "parameter"}, {Field::motor, "bank"}, {Field::value, "value"}};
constexpr Operand parameter_bank[] = {{Field::type, "parameter"}, {Field::motor, "bank"}};
constexpr Operand type_motor[] = {{Field::type, "type"}, {Field::motor, "motor"}};
constexpr Operand port_bank_value[] = {{Field::type, "port"}, {Field::motor, "bank"}, {Field::value, "value"}};
constexpr Operand port_bank[] = {{Field::type, "port"}, {Field::motor, "bank"}};
constexpr Operand operation_value[] = {{Field::type, "operation"}, {Field::value, "value"}};
constexpr Operand one_value[] = {{Field::value, "value"}};
constexpr Operand condition_address[] = {{Field::type, "condition"}, {Field::address, "address"}};
constexpr Operand one_address[] = {{Field::address, "address"}};
constexpr Operand one_interrupt[] = {{Field::type, "interrupt"}};
constexpr Operand condition_motor_ticks[] = {
    {Field::type, "condition"}, {Field::motor, "motor"}, {Field::value, "ticks"}};
constexpr Operand bus_bits_data[] = {{Field::type, "bus"}, {Field::motor, "bits"}, {Field::value, "data"}};
constexpr Operand coordinate_motor_position[] = {
    {Field::type, "coordinate"}, {Field::motor, "motor"}, {Field::value, "position"}};
// The zero belongs to the forms with motor 255, which load coordinates from the EEPROM.
constexpr Operand coordinate_motor_zero[] = {
    {Field::type, "coordinate"}, {Field::motor, "motor"}, {Field::value, "value", true}};
constexpr Operand coordinate_motor[] = {{Field::type, "coordinate"}, {Field::motor, "motor"}};
constexpr Operand one_operation[] = {{Field::type, "operation"}};
constexpr Operand one_flag[] = {{Field::type, "flag"}};
constexpr Operand interrupt_address[] = {{Field::type, "interrupt"}, {Field::address, "address"}};
constexpr Operand operation_variable_variable[] = {
    {Field::type, "operation"}, {Field::motor, "first variable"}, {Field::value, "second variable"}};
constexpr Operand operation_variable[] = {{Field::type, "operation"}, {Field::motor, "variable"}};
constexpr Operand operation_variable_value[] = {
    {Field::type, "operation"}, {Field::motor, "variable"}, {Field::value, "value"}};
constexpr Operand variable_address[] = {{Field::type, "variable"}, {Field::address, "address"}};
// Which operands a user function takes is up to the customer's firmware.
constexpr Operand user_defined[] = {
    {Field::type, "type", true}, {Field::motor, "motor", true}, {Field::value, "value", true}};

constexpr auto commands = std::to_array<CommandInfo>({
    {Command::ROR, "ROR", normal, never, turns, "rotate right: velocity mode, positive speed", motor_velocity},
    {Command::ROL, "ROL", normal, never, turns, "rotate left: velocity mode, negative speed", motor_velocity},
    {Command::MST, "MST", normal, safe, stops, "motor stop", one_motor},
    {Command::MVP, "MVP", normal, never, moves_elsewhere, "move to position", type_motor_position},
    {Command::SAP, "SAP", normal, never, writes_motor, "set axis parameter; some of them move the motor",
     parameter_motor_value},
    {Command::GAP, "GAP", normal, safe, reads, "get axis parameter", parameter_motor},
    {Command::STAP, "STAP", normal, never, writes_motor, "store axis parameter in the EEPROM", parameter_motor},
    {Command::RSAP, "RSAP", normal, never, writes_unseen, "restore axis parameter from the EEPROM", parameter_motor},
    {Command::SGP, "SGP", normal, never, writes_global, "set global parameter; many go straight to the EEPROM",
     parameter_bank_value},
    {Command::GGP, "GGP", normal, safe, reads, "get global parameter", parameter_bank},
    {Command::STGP, "STGP", normal, never, writes, "store global parameter in the EEPROM", parameter_bank},
    {Command::RSGP, "RSGP", normal, never, writes_global, "restore global parameter from the EEPROM", parameter_bank},
    {Command::RFS, "RFS", normal, never, unforeseen_of_motor, "reference search", type_motor},
    {Command::SIO, "SIO", normal, never, writes_output, "set output", port_bank_value},
    {Command::GIO, "GIO", normal, safe, reads, "get input or output", port_bank},
    {Command::CALC, "CALC", normal, never, writes, "calculate with accumulator and constant", operation_value},
    {Command::COMP, "COMP", normal, never, writes, "compare accumulator with constant", one_value},
    {Command::JC, "JC", normal, never, writes, "jump conditionally", condition_address},
    {Command::JA, "JA", normal, never, writes, "jump always", one_address},
    {Command::CSUB, "CSUB", normal, never, writes, "call subroutine", one_address},
    {Command::RSUB, "RSUB", normal, never, writes, "return from subroutine", alone},
    {Command::EI, "EI", normal, never, writes, "enable interrupt", one_interrupt},
    {Command::DI, "DI", normal, never, writes, "disable interrupt", one_interrupt},
    {Command::WAIT, "WAIT", normal, never, writes_motor, "wait for an event", condition_motor_ticks},
    {Command::STOP, "STOP", normal, never, writes, "end of program", alone},
    {Command::SAC, "SAC", normal, never, unforeseen, "SPI bus access", bus_bits_data},
    {Command::SCO, "SCO", normal, never, writes_coordinate, "set coordinate", coordinate_motor_position},
    {Command::GCO, "GCO", normal, safe, reads, "get coordinate", coordinate_motor_zero},
    {Command::CCO, "CCO", normal, never, writes_coordinate, "capture coordinate", coordinate_motor},
    {Command::CALCX, "CALCX", normal, never, writes, "calculate with accumulator and X register", one_operation},
    {Command::AAP, "AAP", normal, never, writes_unseen, "set axis parameter to accumulator", parameter_motor},
    {Command::AGP, "AGP", normal, never, writes_global, "set global parameter to accumulator", parameter_bank},
    {Command::CLE, "CLE", normal, never, writes, "clear error flags", one_flag},
    {Command::VECT, "VECT", normal, never, writes, "set interrupt vector", interrupt_address},
    {Command::RETI, "RETI", normal, never, writes, "return from interrupt", alone},
    {Command::ACO, "ACO", normal, never, writes_coordinate, "set coordinate to accumulator", coordinate_motor},
    {Command::CALCVV, "CALCVV", normal, never, writes, "calculate with two user variables",
     operation_variable_variable},
    {Command::CALCVA, "CALCVA", normal, never, writes, "calculate with user variable and accumulator",
     operation_variable},
    {Command::CALCAV, "CALCAV", normal, never, writes, "calculate with accumulator and user variable",
     operation_variable},
    {Command::CALCVX, "CALCVX", normal, never, writes, "calculate with user variable and X register",
     operation_variable},
    {Command::CALCXV, "CALCXV", normal, never, writes, "calculate with X register and user variable",
     operation_variable},
    {Command::CALCV, "CALCV", normal, never, writes, "calculate with user variable and constant",
     operation_variable_value},
    {Command::MVPA, "MVPA", normal, never, unseen(moves_elsewhere), "move to the position in the accumulator", type_motor},
    {Command::RST, "RST", normal, never, runs_program, "restart the program from an address", one_address},
    {Command::DJNZ, "DJNZ", normal, never, writes, "decrement and jump if not zero", variable_address},
    {Command::ROLA, "ROLA", normal, never, unseen(turns), "rotate left with the accumulator's speed", one_motor},
    {Command::RORA, "RORA", normal, never, unseen(turns), "rotate right with the accumulator's speed", one_motor},
    {Command::SIV, "SIV", normal, never, writes, "set indexed variable", one_value},
    {Command::GIV, "GIV", normal, never, writes, "get indexed variable into the accumulator", alone},
    {Command::AIV, "AIV", normal, never, writes, "set indexed variable to accumulator", alone},
    {Command::UF0, "UF0", normal, never, acts_as_built, "user function 0", user_defined},
    {Command::UF1, "UF1", normal, never, acts_as_built, "user function 1", user_defined},
    {Command::UF2, "UF2", normal, never, acts_as_built, "user function 2", user_defined},
    {Command::UF3, "UF3", normal, never, acts_as_built, "user function 3", user_defined},
    {Command::UF4, "UF4", normal, never, acts_as_built, "user function 4", user_defined},
    {Command::UF5, "UF5", normal, never, acts_as_built, "user function 5", user_defined},
    {Command::UF6, "UF6", normal, never, acts_as_built, "user function 6", user_defined},
    {Command::UF7, "UF7", normal, never, acts_as_built, "user function 7", user_defined},
    {Command::CALL, "CALL", normal, never, writes, "call subroutine conditionally", condition_address},
    {Command::STOP_APPLICATION, "STOP_APPLICATION", normal, never, ends_program, "stop the stand-alone program"},
    {Command::RUN_APPLICATION, "RUN_APPLICATION", normal, never, runs_program, "run the stand-alone program"},
    {Command::STEP_APPLICATION, "STEP_APPLICATION", normal, never, runs_program, "execute one line of the program"},
    {Command::RESET_APPLICATION, "RESET_APPLICATION", normal, never, ends_program, "set the program back to its start"},
    {Command::START_DOWNLOAD, "START_DOWNLOAD", normal, never, writes, "enter download mode"},
    {Command::END_DOWNLOAD, "END_DOWNLOAD", normal, safe, writes, "leave download mode"},
    {Command::READ_TMCL_MEMORY, "READ_TMCL_MEMORY", memory, safe, reads, "read a line of the program"},
    {Command::GET_APPLICATION_STATUS, "GET_APPLICATION_STATUS", normal, safe, reads, "is the program running?"},
    {Command::GET_FIRMWARE_VERSION, "GET_FIRMWARE_VERSION", version, safe, reads, "model and firmware version"},
    {Command::FACTORY_RESET, "FACTORY_RESET", none, never, restarts, "restore factory settings"},
    {Command::TARGET_REACHED_EVENT, "TARGET_REACHED_EVENT", then_event, never, writes,
     "ask for an event when the target is reached"},
    {Command::ENTER_ASCII_MODE, "ENTER_ASCII_MODE", normal, never, writes, "go over to the ASCII form"},
    {Command::SECURITY_CODE, "SECURITY_CODE", normal, never, writes, "security code"},
    {Command::BREAKPOINT, "BREAKPOINT", normal, never, writes, "set or clear a breakpoint"},
    {Command::RAM_DEBUG, "RAM_DEBUG", normal, never, writes,
     "record values at ticks of the module's clock; not every module has it"},
    {Command::GET_IDS, "GET_IDS", normal, safe, reads,
     "identification of the board's parts; firmware of evaluation boards only"},
    {Command::WRITE_USER_CHANNEL, "WRITE_USER_CHANNEL", normal, never, acts_as_built,
     "write to a user function channel; a customer's firmware only"},
    {Command::READ_USER_CHANNEL, "READ_USER_CHANNEL", normal, never, writes,
     "read a user function channel; a customer's firmware only"},
    {Command::WRITE_MC, "WRITE_MC", normal, never, writes_register, "write a register of the motion controller"},
    {Command::WRITE_DRV, "WRITE_DRV", normal, never, writes_register, "write a register of the motor driver"},
    {Command::READ_MC, "READ_MC", normal, never, reads, "read a register of the motion controller"},
    {Command::READ_DRV, "READ_DRV", normal, never, reads, "read a register of the motor driver"},
    {Command::MEASURED_SPEED, "MEASURED_SPEED", normal, safe, reads, "measured speed"},
    {Command::BOARD_ERROR, "BOARD_ERROR", normal, never, reads, "error flags of the board"},
    {Command::BOARD_RESET, "BOARD_RESET", normal, never, acts_as_built, "reset the board"},
    {Command::GET_INFO, "GET_INFO", normal, safe, reads, "identity and abilities of the firmware"},
    {Command::WLAN0, "WLAN0", normal, never, writes, "wireless interface, function 0"},
    {Command::WLAN1, "WLAN1", normal, never, writes, "wireless interface, function 1"},
    {Command::WLAN2, "WLAN2", normal, never, writes, "wireless interface, function 2"},
    {Command::WLAN3, "WLAN3", normal, never, writes, "wireless interface, function 3"},
    {Command::GET_AP_MIN, "GET_AP_MIN", normal, safe, reads, "least value of an axis parameter"},
    {Command::GET_AP_MAX, "GET_AP_MAX", normal, safe, reads, "greatest value of an axis parameter"},
    {Command::OTP, "OTP", normal, never, writes, "one-time programmable memory"},
    {Command::BOOT_ERASE_ALL, "BOOT_ERASE_ALL", normal, never, boot_writes, "bootloader: erase the firmware"},
    {Command::BOOT_WRITE_BUFFER, "BOOT_WRITE_BUFFER", normal, never, boot_writes, "bootloader: fill the page buffer"},
    {Command::BOOT_WRITE_PAGE, "BOOT_WRITE_PAGE", normal, never, boot_writes, "bootloader: write a page"},
    {Command::BOOT_GET_CHECKSUM, "BOOT_GET_CHECKSUM", normal, safe, reads, "bootloader: checksum of the firmware"},
    {Command::BOOT_READ_MEMORY, "BOOT_READ_MEMORY", normal, safe, reads, "bootloader: read memory"},
    {Command::BOOT_START_APPLICATION, "BOOT_START_APPLICATION", none, never, restarts, "bootloader: start the firmware"},
    {Command::BOOT_GET_INFO, "BOOT_GET_INFO", normal, safe, reads, "bootloader: page size and memory size"},
    {Command::BOOT_WRITE_LENGTH, "BOOT_WRITE_LENGTH", normal, never, boot_writes, "bootloader: write length and checksum"},
    {Command::ENTER_BOOTLOADER, "ENTER_BOOTLOADER", none, never, restarts, "leave the firmware for the bootloader"},
    {Command::SOFTWARE_RESET, "SOFTWARE_RESET", normal, never, restarts, "restart the module"},
});

constexpr auto subtypes = std::to_array<SubtypeInfo>({
    {Command::MVP, move_type::absolute, "ABS", never, moves_to},
    {Command::MVP, move_type::relative, "REL", never, moves_by},
    {Command::MVP, move_type::coordinate, "COORD", never, moves_to_coordinate},
    {Command::MVP, 3, "RELCOORD", never, moves_elsewhere},
    // Positions, speeds and the ramp mode, under all the numbers that families of modules use for them.
    {Command::SAP, 0, "", never, writes_target},
    {Command::SAP, 1, "", never, writes_position},
    {Command::SAP, 2, "", never, turns},
    {Command::SAP, 3, "", never, may_turn},
    {Command::SAP, 128, "", never, writes_mode},
    {Command::SAP, 129, "", never, may_turn},
    {Command::SAP, 132, "", never, may_turn},
    {Command::SAP, 133, "", never, may_turn},
    {Command::SAP, 138, "", never, writes_mode},
    {Command::RFS, search_type::start, "START", never, searches},
    {Command::RFS, search_type::stop, "STOP", safe, ends_search},
    {Command::RFS, search_type::status, "STATUS", safe, reads},
    {Command::CALC, 0, "ADD", never, writes},
    {Command::CALC, 1, "SUB", never, writes},
    {Command::CALC, 2, "MUL", never, writes},
    {Command::CALC, 3, "DIV", never, writes},
    {Command::CALC, 4, "MOD", never, writes},
    {Command::CALC, 5, "AND", never, writes},
    {Command::CALC, 6, "OR", never, writes},
    {Command::CALC, 7, "XOR", never, writes},
    {Command::CALC, 8, "NOT", never, writes},
    {Command::CALC, 9, "LOAD", never, writes},
    {Command::JC, 0, "ZE", never, writes},
    {Command::JC, 1, "NZ", never, writes},
    {Command::JC, 2, "EQ", never, writes},
    {Command::JC, 3, "NE", never, writes},
    {Command::JC, 4, "GT", never, writes},
    {Command::JC, 5, "GE", never, writes},
    {Command::JC, 6, "LT", never, writes},
    {Command::JC, 7, "LE", never, writes},
    {Command::JC, 8, "ETO", never, writes},
    {Command::JC, 9, "EAL", never, writes},
    {Command::JC, 10, "EDV", never, writes},
    {Command::JC, 11, "EPO", never, writes},
    {Command::JC, 12, "ESD", never, writes},
    {Command::WAIT, 0, "TICKS", never, writes_motor},
    {Command::WAIT, 1, "POS", never, writes_motor},
    {Command::WAIT, 2, "REFSW", never, writes_motor},
    {Command::WAIT, 3, "LIMSW", never, writes_motor},
    {Command::WAIT, 4, "RFS", never, writes_motor},
    {Command::CALCX, 0, "ADD", never, writes},
    {Command::CALCX, 1, "SUB", never, writes},
    {Command::CALCX, 2, "MUL", never, writes},
    {Command::CALCX, 3, "DIV", never, writes},
    {Command::CALCX, 4, "MOD", never, writes},
    {Command::CALCX, 5, "AND", never, writes},
    {Command::CALCX, 6, "OR", never, writes},
    {Command::CALCX, 7, "XOR", never, writes},
    {Command::CALCX, 8, "NOT", never, writes},
    {Command::CALCX, 9, "LOAD", never, writes},
    {Command::CALCX, 10, "SWAP", never, writes},
    {Command::CLE, 0, "ALL", never, writes},
    {Command::CLE, 1, "ETO", never, writes},
    {Command::CLE, 2, "EAL", never, writes},
    {Command::CLE, 3, "EDV", never, writes},
    {Command::CLE, 4, "EPO", never, writes},
    {Command::CLE, 5, "ESD", never, writes},
    {Command::CALCVV, 0, "ADD", never, writes},
    {Command::CALCVV, 1, "SUB", never, writes},
    {Command::CALCVV, 2, "MUL", never, writes},
    {Command::CALCVV, 3, "DIV", never, writes},
    {Command::CALCVV, 4, "MOD", never, writes},
    {Command::CALCVV, 5, "AND", never, writes},
    {Command::CALCVV, 6, "OR", never, writes},
    {Command::CALCVV, 7, "XOR", never, writes},
    {Command::CALCVV, 8, "NOT", never, writes},
    {Command::CALCVV, 9, "LOAD", never, writes},
    {Command::CALCVV, 10, "SWAP", never, writes},
    {Command::CALCVV, 11, "COMP", never, writes},
    {Command::CALCVA, 0, "ADD", never, writes},
    {Command::CALCVA, 1, "SUB", never, writes},
    {Command::CALCVA, 2, "MUL", never, writes},
    {Command::CALCVA, 3, "DIV", never, writes},
    {Command::CALCVA, 4, "MOD", never, writes},
    {Command::CALCVA, 5, "AND", never, writes},
    {Command::CALCVA, 6, "OR", never, writes},
    {Command::CALCVA, 7, "XOR", never, writes},
    {Command::CALCVA, 8, "NOT", never, writes},
    {Command::CALCVA, 9, "LOAD", never, writes},
    {Command::CALCVA, 10, "SWAP", never, writes},
    {Command::CALCVA, 11, "COMP", never, writes},
    {Command::CALCAV, 0, "ADD", never, writes},
    {Command::CALCAV, 1, "SUB", never, writes},
    {Command::CALCAV, 2, "MUL", never, writes},
    {Command::CALCAV, 3, "DIV", never, writes},
    {Command::CALCAV, 4, "MOD", never, writes},
    {Command::CALCAV, 5, "AND", never, writes},
    {Command::CALCAV, 6, "OR", never, writes},
    {Command::CALCAV, 7, "XOR", never, writes},
    {Command::CALCAV, 8, "NOT", never, writes},
    {Command::CALCAV, 9, "LOAD", never, writes},
    {Command::CALCAV, 10, "SWAP", never, writes},
    {Command::CALCAV, 11, "COMP", never, writes},
    {Command::CALCVX, 0, "ADD", never, writes},
    {Command::CALCVX, 1, "SUB", never, writes},
    {Command::CALCVX, 2, "MUL", never, writes},
    {Command::CALCVX, 3, "DIV", never, writes},
    {Command::CALCVX, 4, "MOD", never, writes},
    {Command::CALCVX, 5, "AND", never, writes},
    {Command::CALCVX, 6, "OR", never, writes},
    {Command::CALCVX, 7, "XOR", never, writes},
    {Command::CALCVX, 8, "NOT", never, writes},
    {Command::CALCVX, 9, "LOAD", never, writes},
    {Command::CALCVX, 10, "SWAP", never, writes},
    {Command::CALCVX, 11, "COMP", never, writes},
    {Command::CALCXV, 0, "ADD", never, writes},
    {Command::CALCXV, 1, "SUB", never, writes},
    {Command::CALCXV, 2, "MUL", never, writes},
    {Command::CALCXV, 3, "DIV", never, writes},
    {Command::CALCXV, 4, "MOD", never, writes},
    {Command::CALCXV, 5, "AND", never, writes},
    {Command::CALCXV, 6, "OR", never, writes},
    {Command::CALCXV, 7, "XOR", never, writes},
    {Command::CALCXV, 8, "NOT", never, writes},
    {Command::CALCXV, 9, "LOAD", never, writes},
    {Command::CALCXV, 10, "SWAP", never, writes},
    {Command::CALCXV, 11, "COMP", never, writes},
    {Command::CALCV, 0, "ADD", never, writes},
    {Command::CALCV, 1, "SUB", never, writes},
    {Command::CALCV, 2, "MUL", never, writes},
    {Command::CALCV, 3, "DIV", never, writes},
    {Command::CALCV, 4, "MOD", never, writes},
    {Command::CALCV, 5, "AND", never, writes},
    {Command::CALCV, 6, "OR", never, writes},
    {Command::CALCV, 7, "XOR", never, writes},
    {Command::CALCV, 8, "NOT", never, writes},
    {Command::CALCV, 9, "LOAD", never, writes},
    {Command::CALCV, 11, "COMP", never, writes},
    {Command::MVPA, move_type::absolute, "ABS", never, unseen(moves_to)},
    {Command::MVPA, move_type::relative, "REL", never, unseen(moves_by)},
    {Command::MVPA, move_type::coordinate, "COORD", never, unseen(moves_to_coordinate)},
    {Command::CALL, 0, "ZE", never, writes},
    {Command::CALL, 1, "NZ", never, writes},
    {Command::CALL, 2, "EQ", never, writes},
    {Command::CALL, 3, "NE", never, writes},
    {Command::CALL, 4, "GT", never, writes},
    {Command::CALL, 5, "GE", never, writes},
    {Command::CALL, 6, "LT", never, writes},
    {Command::CALL, 7, "LE", never, writes},
    {Command::CALL, 8, "ETO", never, writes},
    {Command::CALL, 9, "EAL", never, writes},
    {Command::CALL, 10, "EDV", never, writes},
    {Command::CALL, 11, "EPO", never, writes},
    {Command::RUN_APPLICATION, 0, "CONTINUE", never, runs_program},
    {Command::RUN_APPLICATION, 1, "FROM_ADDRESS", never, runs_program},
    {Command::GET_FIRMWARE_VERSION, 0, "TEXT", safe, reads},
    {Command::GET_FIRMWARE_VERSION, 1, "BINARY", safe, reads},
    {Command::TARGET_REACHED_EVENT, 0, "NEXT_MOVE", never, writes},
    {Command::TARGET_REACHED_EVENT, 1, "EVERY_MOVE", never, writes},
    // What takes the next free channel is not done twice. A trigger is enabled once: more is ignored.
    {Command::RAM_DEBUG, 0, "INIT", safe, writes},
    {Command::RAM_DEBUG, 1, "SET_SAMPLE_COUNT", safe, writes},
    {Command::RAM_DEBUG, 2, "SET_SAMPLING_SOURCE", safe, writes},
    {Command::RAM_DEBUG, 3, "SET_PRESCALER", safe, writes},
    {Command::RAM_DEBUG, 4, "SET_CHANNEL", never, writes},
    {Command::RAM_DEBUG, 5, "SET_TRIGGER_CHANNEL", safe, writes},
    {Command::RAM_DEBUG, 6, "SET_SHIFT_MASK", safe, writes},
    {Command::RAM_DEBUG, 7, "ENABLE_TRIGGER", safe, writes},
    {Command::RAM_DEBUG, 8, "GET_STATE", safe, reads},
    {Command::RAM_DEBUG, 9, "GET_SAMPLE", safe, reads},
    {Command::RAM_DEBUG, 10, "GET_INFO", safe, reads},
    {Command::RAM_DEBUG, 11, "GET_CHANNEL_TYPE", safe, reads},
    {Command::RAM_DEBUG, 12, "GET_CHANNEL_ADDRESS", safe, reads},
    {Command::RAM_DEBUG, 13, "SET_PRETRIGGER_SAMPLE_COUNT", safe, writes},
    {Command::RAM_DEBUG, 14, "GET_PRETRIGGER_SAMPLE_COUNT", safe, reads},
    {Command::RAM_DEBUG, 15, "SET_PROCESS_FREQUENCY", safe, writes},
    {Command::RAM_DEBUG, 16, "SET_TYPE", never, writes},
    {Command::RAM_DEBUG, 17, "SET_EVAL_CHANNEL", safe, writes},
    {Command::RAM_DEBUG, 18, "SET_ADDRESS", safe, writes},
    {Command::RAM_DEBUG, 19, "SET_TRIGGER_TYPE", safe, writes},
    {Command::RAM_DEBUG, 20, "SET_TRIGGER_EVAL_CHANNEL", safe, writes},
    {Command::RAM_DEBUG, 21, "SET_TRIGGER_ADDRESS", safe, writes},
    {Command::GET_INFO, 0, "MODULE_ID", safe, reads},
    {Command::GET_INFO, 1, "VERSION", safe, reads},
    {Command::GET_INFO, 2, "CAPABILITIES", safe, reads},
    {Command::GET_INFO, 3, "RELEASE_TYPE", safe, reads},
    {Command::GET_INFO, 10, "BOOTLOADER_ID", safe, reads},
    {Command::GET_INFO, 11, "BOOTLOADER_VERSION", safe, reads},
    {Command::GET_INFO, 20, "AXIS_PARAMETER_WIDTH", safe, reads},
    {Command::GET_INFO, 21, "REGISTER_ADDRESS_WIDTH", safe, reads},
    {Command::GET_INFO, 30, "GIT_HASH", safe, reads},
    {Command::BOOT_GET_INFO, 0, "PAGE_SIZE", safe, reads},
    {Command::BOOT_GET_INFO, 1, "START", safe, reads},
    {Command::BOOT_GET_INFO, 2, "SIZE", safe, reads},
});
// clang-format on

static_assert(std::ranges::is_sorted(commands, {}, &CommandInfo::command));

constexpr int key_of(Command command, std::uint8_t type) {
  return static_cast<int>(command) << 8 | type;
}
constexpr int key_of_row(const SubtypeInfo& row) { return key_of(row.command, row.type); }
static_assert(std::ranges::is_sorted(subtypes, {}, key_of_row));

/// Where each command stands in the table, plus one; 0 for what TMCL does not define.
constexpr auto places = [] {
  std::array<std::uint8_t, 256> all{};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    all[static_cast<std::uint8_t>(commands[i].command)] = static_cast<std::uint8_t>(i + 1);
  }
  return all;
}();

/// How the compiler writes a number that no enumerator has: in brackets.
template <Command command>
constexpr bool is_named() {
  const std::string_view name = __PRETTY_FUNCTION__;
  return name.substr(name.find("command = ") + 10).front() != '(';
}
template <std::size_t... numbers>
constexpr bool have_rows(std::index_sequence<numbers...>) {
  return ((places[numbers] != 0 || !is_named<static_cast<Command>(numbers)>()) && ...);
}
static_assert(have_rows(std::make_index_sequence<256>()), "a command has no row");

/// Where the types of each command begin among all; those of the next one end them. Most commands
/// have none, and this is asked several times for each exchange.
constexpr auto first_subtypes = [] {
  std::array<std::uint16_t, places.size() + 1> all{};
  for (const auto& row : subtypes) ++all[static_cast<std::uint8_t>(row.command) + 1U];
  for (std::size_t i = 1; i < all.size(); ++i) all[i] += all[i - 1];
  return all;
}();

const SubtypeInfo* find_subtype(Command command, std::uint8_t type) {
  const auto number = static_cast<std::uint8_t>(command);
  const auto* end = subtypes.data() + first_subtypes[number + 1U];
  const auto* row = std::ranges::lower_bound(subtypes.data() + first_subtypes[number], end, type,
                                             {}, &SubtypeInfo::type);
  return row != end && row->type == type ? row : nullptr;
}

}  // namespace

std::span<const CommandInfo> command_table() { return commands; }
std::span<const SubtypeInfo> subtype_table() { return subtypes; }

const CommandInfo* find_command(std::uint8_t number) {
  return places[number] == 0 ? nullptr : &commands[places[number] - 1U];
}

namespace {

/// Decimal, or hexadecimal as 0x43 or $43.
std::optional<std::uint8_t> parse_number(std::string_view text) {
  const auto hexadecimal = parse_hexadecimal(text);
  if (!hexadecimal) return text::parse_byte(text);
  if (*hexadecimal < 0 || *hexadecimal > UINT8_MAX) return std::nullopt;
  return static_cast<std::uint8_t>(*hexadecimal);
}

}  // namespace

std::optional<Command> parse_command(std::string_view text) {
  if (const auto value = parse_number(text)) return static_cast<Command>(*value);
  for (const auto& row : commands) {
    if (text::equal_ignoring_case(row.name, text)) return row.command;
  }
  return std::nullopt;
}

std::optional<std::uint8_t> parse_subtype(Command command, std::string_view text) {
  if (const auto value = parse_number(text)) return value;
  for (const auto& row : subtypes) {
    if (row.command == command && text::equal_ignoring_case(row.name, text)) return row.type;
  }
  return std::nullopt;
}

std::string_view name_of(Command command) {
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  return row != nullptr ? row->name : text::byte_name(static_cast<std::uint8_t>(command));
}

std::string_view name_of_subtype(Command command, std::uint8_t type) {
  const auto* row = find_subtype(command, type);
  return row != nullptr ? row->name : std::string_view{};
}

ReplyKind reply_kind(Command command) {
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  return row != nullptr ? row->reply : ReplyKind::normal;
}

Repeat repeat_rule(Command command, std::uint8_t type) {
  if (const auto* row = find_subtype(command, type)) return row->repeat;
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  return row != nullptr ? row->repeat : Repeat::never;
}

const Intent& intent_of(Command command, std::uint8_t type) {
  if (const auto* row = find_subtype(command, type)) return row->intent;
  const auto* row = find_command(static_cast<std::uint8_t>(command));
  return row != nullptr ? row->intent : unforeseen;
}

}  // namespace tmcl

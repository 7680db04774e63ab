// What each command of a stand-alone program does.
#include <array>
#include <optional>

#include "sim/module/due.hpp"
#include "sim/program/processor.hpp"
#include "tmcl/command.hpp"
#include "tmcl/command_type.hpp"

namespace tmcl::sim {
namespace {

using program::Instruction;

constexpr std::uint8_t clear_all = 0;

/// Whether the table of types is complete for a command.
bool has_types(Command command) {
  static const auto all = [] {
    std::array<bool, 256> found{};
    for (const auto& row : subtype_table()) found[static_cast<std::uint8_t>(row.command)] = true;
    return found;
  }();
  return all[static_cast<std::uint8_t>(command)] && !is_direct(command);
}

bool has_wrong_type(const Instruction& line) {
  return has_types(line.command) && name_of_subtype(line.command, line.type).empty();
}

bool is_read(const Instruction& line) {
  switch (line.command) {
    case Command::GAP:
    case Command::GGP:
    case Command::GIO:
    case Command::GCO: return true;
    case Command::RFS: return line.type == search_type::status;
    default: return false;
  }
}

/// The command that a host would send instead of one that takes its value from the accumulator.
std::optional<Command> with_value(Command command) {
  switch (command) {
    case Command::AAP: return Command::SAP;
    case Command::AGP: return Command::SGP;
    case Command::ACO: return Command::SCO;
    case Command::MVPA: return Command::MVP;
    case Command::ROLA: return Command::ROL;
    case Command::RORA: return Command::ROR;
    default: return std::nullopt;
  }
}

}  // namespace

bool is_direct(Command command) {
  switch (command) {
    case Command::ROR:
    case Command::ROL:
    case Command::MST:
    case Command::MVP:
    case Command::SAP:
    case Command::GAP:
    case Command::STAP:
    case Command::RSAP:
    case Command::SGP:
    case Command::GGP:
    case Command::STGP:
    case Command::RSGP:
    case Command::RFS:
    case Command::SIO:
    case Command::GIO:
    case Command::SAC:
    case Command::SCO:
    case Command::GCO:
    case Command::CCO:
    case Command::UF0:
    case Command::UF1:
    case Command::UF2:
    case Command::UF3:
    case Command::UF4:
    case Command::UF5:
    case Command::UF6:
    case Command::UF7: return true;
    default: return false;
  }
}

// The manuals print answers in direct mode for calculations (TMCM-6212 V1.11: AGP, CALC; TMCM-1211
// V1.10: CALCX; TMCM-3351), and hosts set up interrupts in it. Of comparisons, jumps and waiting
// they say that they are for programs.
bool is_direct_calculation(Command command) {
  switch (command) {
    case Command::CALC:
    case Command::CALCX:
    case Command::CALCV:
    case Command::CALCVV:
    case Command::CALCVA:
    case Command::CALCAV:
    case Command::CALCVX:
    case Command::CALCXV:
    case Command::EI:
    case Command::DI:
    case Command::VECT: return true;
    default: return with_value(command).has_value();
  }
}

Status Processor::execute(const Instruction& line, TimePoint now) {
  if (has_wrong_type(line)) return Status::wrong_type;
  if (const auto status = calculator_.execute(line)) return *status;
  switch (line.command) {
    case Command::JC: return jump_if(condition(line.type), line.value);
    case Command::JA: return jump_if(true, line.value);
    case Command::CSUB: return call_if(true, line.value);
    case Command::CALL: return call_if(condition(line.type), line.value);
    case Command::RSUB: return return_from_call();
    case Command::DJNZ: return count_down(line);
    case Command::EI:
    case Command::DI: return switch_interrupt(line, now);
    case Command::VECT: return set_vector(line);
    case Command::RETI: return return_from_interrupt();
    case Command::WAIT: return begin_wait(line, now);
    case Command::STOP: return end_program();
    case Command::RST: return restart(line.value);
    case Command::CLE: return clear_errors(line);
    default: return perform(line);
  }
}

Status Processor::perform(const Instruction& line) {
  Request request{ModuleAddress{1}, line.command, line.type, line.motor, line.value};
  if (const auto command = with_value(line.command)) {
    request.command = *command;
    request.value = calculator_.registers.accumulator;
  } else if (!is_direct(line.command)) {
    return Status::invalid_command;
  }
  const auto answer = host_->perform(request);
  if (!is_success(answer.status)) return answer.status;
  if (is_read(line)) calculator_.read(answer.value);
  return Status::ok;
}

bool Processor::condition(std::uint8_t type) const {
  using Condition = Calculator::Condition;
  const auto condition = static_cast<Condition>(type);
  if (condition < Condition::first_error) return calculator_.meets(condition);
  return (errors_ >> (type - static_cast<unsigned>(Condition::first_error)) & 1U) != 0;
}

Status Processor::jump_if(bool condition, std::int32_t address) {
  if (!memory_->has(address)) return Status::invalid_value;
  if (condition) next_ = static_cast<std::uint16_t>(address);
  return Status::ok;
}

Status Processor::call_if(bool condition, std::int32_t address) {
  if (condition && calls_.size() == deepest_call) return Status::maximum_exceeded;
  const auto behind = next_;
  const auto status = jump_if(condition, address);
  if (condition && status == Status::ok) calls_.push_back(behind);
  return status;
}

Status Processor::return_from_call() {
  if (calls_.empty()) return Status::command_not_available;
  next_ = calls_.back();
  calls_.pop_back();
  return Status::ok;
}

Status Processor::count_down(const Instruction& line) {
  if (!memory_->has(line.value)) return Status::invalid_value;
  const auto left = static_cast<std::uint32_t>(host_->user_variable(line.type)) - 1U;
  host_->set_user_variable(line.type, static_cast<std::int32_t>(left));
  return jump_if(left != 0, line.value);
}

Status Processor::switch_interrupt(const Instruction& line, TimePoint now) {
  if (line.type != interrupt::global_enable && !interrupts_.exists(line.type))
    return Status::wrong_type;
  if (line.command == Command::EI) {
    interrupts_.enable(line.type, now);
  } else {
    interrupts_.disable(line.type);
  }
  return Status::ok;
}

Status Processor::set_vector(const Instruction& line) {
  if (!interrupts_.exists(line.type)) return Status::wrong_type;
  if (!memory_->has(line.value)) return Status::invalid_value;
  interrupts_.set_vector(line.type, static_cast<std::uint16_t>(line.value));
  return Status::ok;
}

Status Processor::return_from_interrupt() {
  if (!interrupted_) return Status::command_not_available;
  calculator_.registers = interrupted_->registers;
  next_ = interrupted_->counter;
  wait_ = interrupted_->wait;
  interrupted_.reset();
  return Status::ok;
}

Status Processor::begin_wait(const Instruction& line, TimePoint now) {
  const auto what = static_cast<WaitFor>(line.type);
  const bool for_time = what == WaitFor::ticks;
  if (line.value < 0 || (!for_time && line.motor >= host_->motors())) return Status::invalid_value;
  const bool forever = !for_time && line.value == 0;
  const Wait wait{what, line.motor, forever ? never : now + line.value * wait_tick};
  if (has_happened(wait) || wait.end <= now) return Status::ok;
  wait_ = wait;
  next_ = counter_;
  return Status::ok;
}

Status Processor::end_program() {
  stop();
  return Status::ok;
}

// Everything but breakpoints begins anew.
Status Processor::restart(std::int32_t address) {
  if (!memory_->has(address)) return Status::invalid_value;
  const auto state = state_;
  clear();
  state_ = state;
  next_ = static_cast<std::uint16_t>(address);
  return Status::ok;
}

Status Processor::clear_errors(const Instruction& line) {
  errors_ = line.type == clear_all ? std::uint8_t{0}
                                   : static_cast<std::uint8_t>(errors_ & ~(1U << (line.type - 1U)));
  return Status::ok;
}

}  // namespace tmcl::sim

#include "sim/program/calculator.hpp"

#include "sim/program/calculation.hpp"
#include "tmcl/command.hpp"

namespace tmcl::sim {
namespace {

using program::Instruction;

bool is_variable(std::int32_t number) { return number >= 0 && number <= UINT8_MAX; }

}  // namespace

std::optional<Status> Calculator::execute(const Instruction& line) {
  const Cell accumulator{Cell::Kind::accumulator};
  const Cell x{Cell::Kind::x};
  const Cell variable{Cell::Kind::variable, line.motor};
  const Cell constant{Cell::Kind::constant, line.value};
  switch (line.command) {
    case Command::CALC: return calculate(line, accumulator, constant);
    case Command::CALCX: return calculate_with_x(line);
    case Command::CALCVV: return calculate_two_variables(line);
    case Command::CALCVA: return calculate(line, variable, accumulator);
    case Command::CALCAV: return calculate(line, accumulator, variable);
    case Command::CALCVX: return calculate(line, variable, x);
    case Command::CALCXV: return calculate(line, x, variable);
    case Command::CALCV: return calculate(line, variable, constant);
    case Command::COMP: return compare(registers.accumulator, line.value);
    case Command::SIV: return set_indexed(line.value);
    case Command::AIV: return set_indexed(registers.accumulator);
    case Command::GIV: return get_indexed();
    default: return std::nullopt;
  }
}

Status Calculator::calculate(const Instruction& line, Cell target, Cell source) {
  const auto calculation = static_cast<Calculation>(line.type);
  if (calculation == Calculation::compare) return compare(load(target), load(source));
  const auto result = sim::calculate(calculation, {load(target), load(source)});
  if (!result) return result.error();
  store(target, result->target);
  if (calculation == Calculation::swap) store(source, result->source);
  registers.zero = result->target == 0;
  return Status::ok;
}

// Only here the two that have one operand change the second register.
Status Calculator::calculate_with_x(const Instruction& line) {
  const Cell accumulator{Cell::Kind::accumulator};
  const Cell x{Cell::Kind::x};
  const auto calculation = static_cast<Calculation>(line.type);
  const bool changes_x = calculation == Calculation::invert || calculation == Calculation::load;
  return changes_x ? calculate(line, x, accumulator) : calculate(line, accumulator, x);
}

Status Calculator::calculate_two_variables(const Instruction& line) {
  if (!is_variable(line.value)) return Status::invalid_value;
  return calculate(line, {Cell::Kind::variable, line.motor}, {Cell::Kind::variable, line.value});
}

Status Calculator::compare(std::int32_t value, std::int32_t with) {
  registers.compared = value <=> with;
  return Status::ok;
}

Status Calculator::set_indexed(std::int32_t value) {
  if (!is_variable(registers.x)) return Status::invalid_value;
  store({Cell::Kind::variable, registers.x}, value);
  return Status::ok;
}

Status Calculator::get_indexed() {
  if (!is_variable(registers.x)) return Status::invalid_value;
  read(load({Cell::Kind::variable, registers.x}));
  return Status::ok;
}

std::int32_t Calculator::load(Cell cell) const {
  switch (cell.kind) {
    case Cell::Kind::accumulator: return registers.accumulator;
    case Cell::Kind::x: return registers.x;
    case Cell::Kind::variable: return host_->user_variable(static_cast<std::uint8_t>(cell.number));
    case Cell::Kind::constant: return cell.number;
  }
  return 0;
}

void Calculator::store(Cell cell, std::int32_t value) {
  switch (cell.kind) {
    case Cell::Kind::accumulator: registers.accumulator = value; return;
    case Cell::Kind::x: registers.x = value; return;
    case Cell::Kind::variable:
      host_->set_user_variable(static_cast<std::uint8_t>(cell.number), value);
      return;
    case Cell::Kind::constant: return;
  }
}

void Calculator::read(std::int32_t value) {
  registers.accumulator = value;
  registers.zero = value == 0;
}

bool Calculator::meets(Condition condition) const {
  const auto compared = registers.compared;
  switch (condition) {
    case Condition::zero: return registers.zero;
    case Condition::not_zero: return !registers.zero;
    case Condition::equal: return compared == 0;
    case Condition::not_equal: return compared != 0;
    case Condition::greater: return compared > 0;
    case Condition::greater_or_equal: return compared >= 0;
    case Condition::less: return compared < 0;
    case Condition::less_or_equal: return compared <= 0;
    case Condition::first_error: break;
  }
  return false;
}

}  // namespace tmcl::sim

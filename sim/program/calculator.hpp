/// The registers of a stand-alone program, and the commands that work on nothing else.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>

#include "sim/program/host.hpp"
#include "tmcl/program.hpp"
#include "tmcl/status.hpp"

namespace tmcl::sim {

class Calculator {
 public:
  struct Registers {
    std::int32_t accumulator = 0;
    std::int32_t x = 0;
    bool zero = true;
    std::strong_ordering compared = std::strong_ordering::equal;
  };
  /// Types of JC and CALL.
  enum class Condition : std::uint8_t {
    zero,
    not_zero,
    equal,
    not_equal,
    greater,
    greater_or_equal,
    less,
    less_or_equal,
    first_error,
  };

  /// The host, which has the user variables, must outlive it.
  explicit Calculator(ProgramHost& host) : host_(&host) {}

  /// Nothing if the command is not one of its own.
  std::optional<Status> execute(const program::Instruction& line);
  /// What a command read goes to the accumulator.
  void read(std::int32_t value);
  /// One before first_error.
  bool meets(Condition condition) const;

  Registers registers;

 private:
  /// Where an operand is; a constant is its own number.
  struct Cell {
    enum class Kind : std::uint8_t { accumulator, x, variable, constant } kind;
    std::int32_t number = 0;
  };

  Status calculate(const program::Instruction& line, Cell target, Cell source);
  Status calculate_with_x(const program::Instruction& line);
  Status calculate_two_variables(const program::Instruction& line);
  Status compare(std::int32_t value, std::int32_t with);
  Status set_indexed(std::int32_t value);
  Status get_indexed();
  std::int32_t load(Cell cell) const;
  void store(Cell cell, std::int32_t value);

  ProgramHost* host_;
};

}  // namespace tmcl::sim

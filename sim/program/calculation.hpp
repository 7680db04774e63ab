/// The arithmetic of stand-alone programs: 32 bits that wrap.
#pragma once

#include <cstdint>

#include <tl/expected.hpp>

#include "tmcl/status.hpp"

namespace tmcl::sim {

/// Types of CALC and of all its relatives, though none of them knows all of these.
enum class Calculation : std::uint8_t {
  add = 0,
  subtract = 1,
  multiply = 2,
  divide = 3,
  modulo = 4,
  bitwise_and = 5,
  bitwise_or = 6,
  exclusive_or = 7,
  invert = 8,
  load = 9,
  swap = 10,
  compare = 11,
};

/// What the two operands are afterwards.
struct Operands {
  std::int32_t target;
  std::int32_t source;
  bool operator==(const Operands&) const = default;
};

/// Only the target changes, except by swap. Inverting takes no account of the source; division
/// rounds towards zero and the remainder has the sign of the target, as in C; comparing changes
/// nothing. Errors: invalid_value for a division by zero (the manuals leave it open), wrong_type
/// for what is no calculation.
constexpr tl::expected<Operands, Status> calculate(Calculation calculation, Operands operands) {
  const auto [target, source] = operands;
  const auto a = static_cast<std::uint32_t>(target);
  const auto b = static_cast<std::uint32_t>(source);
  const auto set = [source = source](auto value) {
    return Operands{static_cast<std::int32_t>(value), source};
  };
  switch (calculation) {
    case Calculation::add: return set(a + b);
    case Calculation::subtract: return set(a - b);
    case Calculation::multiply: return set(a * b);
    case Calculation::divide:
      if (source == 0) return tl::unexpected(Status::invalid_value);
      return set(std::int64_t{target} / source);
    case Calculation::modulo:
      if (source == 0) return tl::unexpected(Status::invalid_value);
      return set(std::int64_t{target} % source);
    case Calculation::bitwise_and: return set(a & b);
    case Calculation::bitwise_or: return set(a | b);
    case Calculation::exclusive_or: return set(a ^ b);
    case Calculation::invert: return set(~a);
    case Calculation::load: return set(source);
    case Calculation::swap: return Operands{source, target};
    case Calculation::compare: return operands;
  }
  return tl::unexpected(Status::wrong_type);
}

}  // namespace tmcl::sim

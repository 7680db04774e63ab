#include "program/expression.hpp"

#include <array>
#include <charconv>
#include <optional>

namespace tmcl::program {
namespace {

// So deep may parentheses and signs be nested.
constexpr int deepest = 50;

struct Operator {
  char sign;
  int tightness;
};
constexpr auto operators = std::to_array<Operator>(
    {{'|', 1}, {'^', 2}, {'&', 3}, {'+', 4}, {'-', 4}, {'*', 5}, {'/', 5}, {'%', 5}});

std::optional<Operator> operator_of(char sign) {
  for (const auto& row : operators) {
    if (row.sign == sign) return row;
  }
  return std::nullopt;
}

// Nothing where the result does not fit, or where there is none.
std::optional<std::int64_t> compute(std::int64_t left, char sign, std::int64_t right) {
  std::int64_t result = 0;
  switch (sign) {
    case '|': return left | right;
    case '^': return left ^ right;
    case '&': return left & right;
    case '+':
      return __builtin_add_overflow(left, right, &result) ? std::nullopt : std::optional(result);
    case '-':
      return __builtin_sub_overflow(left, right, &result) ? std::nullopt : std::optional(result);
    case '*':
      return __builtin_mul_overflow(left, right, &result) ? std::nullopt : std::optional(result);
    default: break;
  }
  // The one quotient that does not fit.
  if (right == 0 || (left == INT64_MIN && right == -1)) return std::nullopt;
  return sign == '/' ? left / right : left % right;
}

/// After the first fault it computes on with zeros.
class Evaluator {
 public:
  Evaluator(Cursor cursor, const Lookup& lookup) : cursor_(cursor), lookup_(lookup) {}

  tl::expected<std::int64_t, TextProblem> whole() {
    const auto value = sum(1);
    if (!cursor_.at_end()) fail("'" + cursor_.word() + "' is not expected here");
    if (fault_) return tl::unexpected(*fault_);
    return value;
  }

 private:
  std::int64_t fail(std::string message) { return fail(cursor_, std::move(message)); }
  std::int64_t fail(const Cursor& where, std::string message) {
    if (!fault_) fault_ = within_line(where.at(), where.word(), std::move(message));
    return 0;
  }

  /// Operands, and the operators between them that are at least so tight.
  std::int64_t sum(int least_tightness) {
    auto left = operand();
    while (!fault_) {
      const auto where = cursor_;
      const auto sign = operator_of(cursor_.peek());
      if (!sign || sign->tightness < least_tightness) break;
      cursor_.skip();
      const auto right = sum(sign->tightness + 1);
      if (fault_) break;
      const auto result = compute(left, sign->sign, right);
      if (!result) return fail(where, right == 0 ? "division by 0" : "the result exceeds 64 bits");
      left = *result;
    }
    return left;
  }

  std::int64_t operand() {
    if (++depth_ > deepest) return fail("this is nested too deep");
    cursor_.skip_blanks();
    const auto value = unary();
    cursor_.skip_blanks();
    --depth_;
    return value;
  }

  std::int64_t unary() {
    const auto where = cursor_;
    if (cursor_.take('+')) return operand();
    if (cursor_.take('~')) return ~operand();
    if (cursor_.take('-')) {
      const auto negative = compute(0, '-', operand());
      return negative ? *negative : fail(where, "the result exceeds 64 bits");
    }
    if (cursor_.take('(')) {
      const auto value = sum(1);
      return cursor_.take(')') ? value : fail("')' is missing");
    }
    return begins_name(cursor_.peek()) ? name() : number();
  }

  std::int64_t name() {
    const auto where = cursor_;
    const auto value = lookup_(cursor_.take_while(is_in_name));
    return value ? *value : fail(where, value.error());
  }

  std::int64_t number() {
    const auto where = cursor_;
    if (cursor_.take('$')) return digits(where, 16);
    if (cursor_.take('%')) return digits(where, 2);
    if (cursor_.peek() == '0' && (cursor_.peek(1) == 'x' || cursor_.peek(1) == 'X')) {
      cursor_.skip();
      cursor_.skip();
      return digits(where, 16);
    }
    return digits(where, 10);
  }

  std::int64_t digits(const Cursor& where, int base) {
    const auto text = cursor_.take_while(is_in_name);
    if (text.empty()) return fail(where, "a value is missing");
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (end != text.data() + text.size() || error == std::errc::invalid_argument)
      return fail(where, "'" + printable(text) + "' is no " + name_of(base) + " number");
    constexpr std::int64_t patterns = std::int64_t{1} << 32;
    if (error != std::errc{} || (base != 10 && value >= patterns))
      return fail(where, "'" + printable(text) + "' is too large a number");
    return base == 10 ? value : static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
  }

  static std::string name_of(int base) {
    return base == 16 ? "hexadecimal" : base == 2 ? "binary" : "decimal";
  }

  Cursor cursor_;
  const Lookup& lookup_;
  int depth_ = 0;
  std::optional<TextProblem> fault_;
};

}  // namespace

tl::expected<std::int64_t, TextProblem> evaluate(Cursor cursor, const Lookup& lookup) {
  return Evaluator(cursor, lookup).whole();
}

}  // namespace tmcl::program

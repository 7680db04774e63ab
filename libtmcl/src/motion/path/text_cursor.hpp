/// Reading texts line by line and word by word.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "tmcl/plan/text_bounds.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::plan {

/// White space within a line; some programs write form feeds, or end lines with \r\r\n.
constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}
/// Whether two positions are the same but for rounding: sums of steps, or inches and mm, differ in
/// their last bits, which no file means.
inline bool are_equal(double one, double other) {
  constexpr double rounding = 1e-9;
  return std::abs(one - other) <= rounding * std::max({1.0, std::abs(one), std::abs(other)});
}
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
constexpr char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Printable and not too long, whatever a text contains: other characters are named, as \t or
/// <U+00A0>.
std::string shown(std::string_view word);

/// A place in one line.
class TextCursor {
 public:
  explicit TextCursor(std::string_view line) : line_(line) {}

  std::size_t column() const { return at_ + 1; }
  bool at_end() const { return at_ == line_.size(); }
  char peek() const { return at_end() ? '\0' : line_[at_]; }
  std::string_view rest() const { return line_.substr(at_); }
  void skip(std::size_t count = 1) { at_ = std::min(at_ + count, line_.size()); }
  void skip_to(std::size_t column) { at_ = std::clamp(column - 1, at_, line_.size()); }
  void skip_blanks() {
    while (is_blank(peek())) skip();
  }
  /// Takes this character, if it is the next after blanks.
  bool take(char wanted) {
    skip_blanks();
    if (at_end() || peek() != wanted) return false;
    skip();
    return true;
  }
  template <class Predicate>
  std::string_view take_while(Predicate belongs) {
    const auto begin = at_;
    while (!at_end() && belongs(peek())) skip();
    return line_.substr(begin, at_ - begin);
  }
  /// What stands here until the next blank or separator, to be shown.
  std::string_view word() const {
    const auto text = rest();
    return text.substr(0, std::max<std::size_t>(1, text.find_first_of(" \t\r\f\v,;:=")));
  }
  /// A finite decimal number; nothing is taken if there is none.
  std::optional<double> take_number(std::chars_format format = std::chars_format::general) {
    auto text = rest();
    const bool plus = text.starts_with('+');
    if (plus) text.remove_prefix(1);
    const auto digits = text.substr(!plus && text.starts_with('-') ? 1 : 0);
    // Names such as inf and nan are no numbers.
    if (digits.empty() || !(is_digit(digits.front()) || digits.front() == '.')) return std::nullopt;
    double value = 0;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), value, format);
    if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
    skip(static_cast<std::size_t>(end - text.data()) + (plus ? 1 : 0));
    return value;
  }

 private:
  std::string_view line_;
  std::size_t at_ = 0;
};

/// Gathers what is wrong.
class ProblemList {
 public:
  explicit ProblemList(std::size_t most = most_text_problems) : most_(most) {}
  void add(std::size_t line, std::size_t column, std::string message) {
    if (!full()) problems_.push_back({line, column, std::move(message)});
  }
  /// Nothing if there is such a message already, of whatever line.
  void add_once(std::size_t line, std::size_t column, std::string message) {
    if (std::ranges::find(problems_, message, &TextProblem::message) == problems_.end())
      add(line, column, std::move(message));
  }
  bool full() const { return problems_.size() >= most_; }
  bool empty() const { return problems_.empty(); }
  /// By their places.
  TextProblems take() {
    std::ranges::stable_sort(problems_, {}, [](const TextProblem& problem) {
      return std::pair(problem.line, problem.column);
    });
    return std::move(problems_);
  }

 private:
  std::size_t most_;
  TextProblems problems_;
};

/// Takes the first line off a text, without its end: \n with any \r before it, or \r in a text that
/// has no \n at all.
std::string_view take_line(std::string_view& text, char end);

/// What spreadsheets write before the first line of UTF-8.
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// What to say of a text in UTF-16 or UTF-32, of which nothing can be read; else nothing.
std::optional<std::string> objection_to_encoding(std::string_view text);

/// Calls `read(line, number)` for each line, without its end, until `problems` are many or `read`
/// returns false.
template <class Read>
void for_each_line(std::string_view text, ProblemList& problems, Read read) {
  if (auto objection = objection_to_encoding(text))
    return problems.add(1, 0, std::move(*objection));
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  const char end = text.find('\n') == std::string_view::npos ? '\r' : '\n';
  for (std::size_t number = 1; !text.empty() && !problems.full(); ++number) {
    if (number > most_text_lines)
      return problems.add(
          number, 0, "there are too many lines; " + std::to_string(most_text_lines) + " at most");
    const auto line = take_line(text, end);
    if (line.size() > most_text_line_bytes) {
      problems.add(
          number, most_text_line_bytes + 1,
          "the line is too long; " + std::to_string(most_text_line_bytes) + " bytes at most");
    } else if (!read(line, number)) {
      return;
    }
  }
}

}  // namespace tmcl::plan

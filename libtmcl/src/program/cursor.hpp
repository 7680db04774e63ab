/// A reader's place in a line of a program.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tmcl::program {

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
constexpr bool is_in_name(char c) { return begins_name(c) || is_digit(c); }
constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// For a message: no control characters, and not longer than a message should be.
inline std::string printable(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string word(text.substr(0, longest));
  for (auto& c : word) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text.size() > longest ? word + "..." : word;
}

/// Columns are offsets into the line, whichever part of it is read.
class Cursor {
 public:
  explicit Cursor(std::string_view line) : line_(line) {}
  /// Reads only what stands from `begin` to before `end`.
  Cursor(std::string_view line, std::size_t begin, std::size_t end)
      : line_(line.substr(0, end)), at_(begin) {}

  std::size_t at() const { return at_; }
  bool at_end() const { return at_ >= line_.size(); }
  /// What comes next; '\0' at the end.
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < line_.size() ? line_[at_ + ahead] : '\0';
  }
  void skip() { ++at_; }
  void skip_blanks() {
    while (is_blank(peek())) ++at_;
  }
  bool take(char c) {
    if (at_end() || peek() != c) return false;
    ++at_;
    return true;
  }
  template <class Condition>
  std::string_view take_while(Condition holds) {
    const auto begin = at_;
    while (!at_end() && holds(peek())) ++at_;
    return line_.substr(begin, at_ - begin);
  }
  std::string_view take_rest() {
    const auto rest = at_end() ? std::string_view{} : line_.substr(at_);
    at_ = line_.size();
    return rest;
  }
  /// The name, number or character that comes next.
  std::string word() const {
    auto ahead = *this;
    const auto name = ahead.take_while(is_in_name);
    return printable(name.empty() && !at_end() ? line_.substr(at_, 1) : name);
  }

 private:
  std::string_view line_;
  std::size_t at_ = 0;
};

}  // namespace tmcl::program

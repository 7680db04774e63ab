#include "motion/path/gcode_block.hpp"

#include <charconv>

#include <fmt/format.h>

namespace tmcl::plan::path_file::gcode {
namespace {

constexpr std::string_view known_letters = "GXYZABCIJKRPQLHFSTMNO";

/// Also up to a comment: an expression such as #1=[2*3] is one word.
std::string_view up_to_blank(const TextCursor& cursor) {
  return cursor.rest().substr(0, cursor.rest().find_first_of(" \t\r\f\v;("));
}

/// Behind the number of a program there is nothing but a comment.
bool has_more(TextCursor cursor) {
  cursor.skip_blanks();
  return !cursor.at_end() && cursor.peek() != ';' && cursor.peek() != '(';
}

}  // namespace

Block::Block(std::string_view line) {
  TextCursor cursor(line);
  while (skip_nothings(cursor)) add(cursor);
}

std::size_t Block::column_of(std::string_view letters) const {
  for (const char letter : letters) {
    if (has(letter)) return find(letter)->column;
  }
  return 1;
}

/// Blanks and comments; false at the end.
bool Block::skip_nothings(TextCursor& cursor) {
  while (true) {
    cursor.skip_blanks();
    if (cursor.at_end() || cursor.peek() == ';') return false;
    if (cursor.peek() != '(') return true;
    const auto end = cursor.rest().find(')');
    if (end == std::string_view::npos) {
      wrongs_.push_back({cursor.column(), "')' is missing", {}, true});
      return false;
    }
    cursor.skip(end + 1);
  }
}

void Block::add(TextCursor& cursor) {
  const auto column = cursor.column();
  const auto text = cursor.rest();
  const auto word = up_to_blank(cursor);
  const char letter = upper(cursor.peek());
  cursor.skip();
  cursor.skip_blanks();
  const auto value = cursor.take_number(std::chars_format::fixed);
  if (known_letters.find(letter) == std::string_view::npos) {
    const bool is_word = value && is_letter(letter);
    const auto taken = is_word ? text.substr(0, cursor.column() - column) : word;
    if (!is_word) cursor.skip_to(column + word.size());
    wrongs_.push_back({column, fmt::format("'{}' is not known here", shown(taken)),
                       text.substr(0, 1), !is_word, is_word});
  } else if (letter == 'O' && (!value || has_more(cursor))) {
    wrongs_.push_back({column, "O words that call, repeat or decide are not read", {}, true});
    cursor.skip(text.size());
  } else if (!value) {
    add_missing_number(cursor, column, letter);
  } else {
    add(letter, {*value, column});
  }
}

void Block::add_missing_number(TextCursor& cursor, std::size_t column, char letter) {
  auto message = fmt::format("a number is missing behind {}", letter);
  // What stands there instead may be long, such as #1 or [2*3].
  const auto instead = is_letter(cursor.peek()) ? std::string_view{} : up_to_blank(cursor);
  if (!instead.empty()) message += fmt::format("; '{}' is none", shown(instead));
  cursor.skip(instead.size());
  wrongs_.push_back({column, std::move(message), instead.substr(0, 1), true});
}

void Block::add(char letter, const Word& read) {
  if (letter == 'G' || letter == 'M') return (letter == 'G' ? g_ : m_).push_back(read);
  auto& word = words_[static_cast<std::size_t>(letter - 'A')];
  if (word) {
    wrongs_.push_back({read.column, fmt::format("{} stands twice on this line", letter), {}, true});
  }
  word = read;
}

}  // namespace tmcl::plan::path_file::gcode

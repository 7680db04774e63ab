/// One line of G-code as its words.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "motion/path/text_cursor.hpp"

namespace tmcl::plan::path_file::gcode {

/// What is wrong with a line.
struct Wrong {
  std::size_t column;
  std::string message;
  std::string_view unknown_letter{};  ///< If it is about a word that begins so.
  /// Whether it is not known any more what the lines behind it would do.
  bool confuses = false;
  bool may_be_skipped = false;  ///< It is a word that is not known.
};
template <class T>
using Part = tl::expected<T, Wrong>;

inline tl::unexpected<Wrong> wrong(std::size_t column, std::string message) {
  return tl::unexpected(Wrong{column, std::move(message)});
}

/// X, Y and Z, which are lengths; A, B and C are angles.
constexpr std::size_t linear_axes = 3;
constexpr std::string_view centre_letters = "IJK";
constexpr std::string_view arc_letters = "IJKR";

/// A letter and its number.
struct Word {
  double value = 0;
  std::size_t column = 0;
};

/// Its words by letter; of G and M there may be several. What is no word of the program is left out
/// of it.
class Block {
 public:
  explicit Block(std::string_view line);

  const std::vector<Wrong>& wrongs() const { return wrongs_; }
  const std::vector<Word>& g() const { return g_; }
  const std::vector<Word>& m() const { return m_; }
  bool has(char letter) const { return find(letter).has_value(); }
  bool has_any(std::string_view letters) const {
    return std::ranges::any_of(letters, [&](char letter) { return has(letter); });
  }
  const std::optional<Word>& find(char letter) const {
    return words_[static_cast<std::size_t>(letter - 'A')];
  }
  /// Where the first of these stands.
  std::size_t column_of(std::string_view letters) const;

 private:
  bool skip_nothings(TextCursor& cursor);
  void add(TextCursor& cursor);
  void add_missing_number(TextCursor& cursor, std::size_t column, char letter);
  void add(char letter, const Word& read);

  std::vector<Wrong> wrongs_;
  std::vector<Word> g_;
  std::vector<Word> m_;
  std::array<std::optional<Word>, 26> words_{};
};

}  // namespace tmcl::plan::path_file::gcode

/// A table of where an axis really is, by where its steps say: of a screw whose pitch is not even,
/// for example, as an interferometer or a length gauge has measured it.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "tmcl/text_problem.hpp"

namespace tmcl {

/// Between two rows the error changes evenly; beyond the first and the last one it stays. Both
/// directions are exact inverses of each other.
class Correction {
 public:
  struct Row {
    double counted = 0;  ///< In the unit of the axis, by its steps alone.
    double actual = 0;   ///< In the same unit, where it is then.
  };
  static constexpr std::size_t most_rows = 10'000;
  /// By how much the way between two rows may differ from that by the steps, in parts.
  static constexpr double most_difference = 0.1;

  /// Two numbers a line, `counted` and `actual`, with a comma or blanks between them, both rising.
  /// What follows `#` is a comment, and a first line that begins with a letter names the columns.
  /// Errors: a line with anything else, fewer than two rows, most_rows, most_difference.
  static tl::expected<Correction, TextProblem> of(std::string_view text);

  double actual(double counted) const;
  double counted(double actual) const;
  /// The same in a unit of which `count` make one of this.
  Correction in_unit(double count) const;
  const std::vector<Row>& rows() const { return rows_; }

 private:
  explicit Correction(std::vector<Row> rows) : rows_(std::move(rows)) {}

  std::vector<Row> rows_;
};

}  // namespace tmcl

/// What G words say once for all lines behind them.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_codes.hpp"

namespace tmcl::plan::path_file::gcode {

class Modes {
 public:
  /// Those that a line sets.
  void take(const Codes& codes);

  /// The first axis of G17, G18 or G19, and the second.
  const std::array<std::size_t, 2>& plane() const { return plane_; }
  /// mm of the program's unit.
  double unit() const { return unit_; }
  double in_mm(const Word& word, std::size_t axis) const {
    return word.value * (axis < linear_axes ? unit_ : 1);
  }
  bool is_absolute() const { return absolute_; }
  bool has_absolute_centres() const { return absolute_centres_; }
  /// What G0 to G3 say; nothing where none holds.
  std::optional<int> motion() const { return motion_; }
  bool is_arc() const { return motion_ == 2 || motion_ == 3; }
  /// By a code that was skipped.
  bool is_motion_hidden() const { return motion_is_hidden_; }
  /// Whether G2 or G3 takes the words of this line.
  bool make_arc(const Block& block, const Codes& codes) const;

 private:
  void take_motion(const Codes& codes);

  std::array<std::size_t, 2> plane_{0, 1};
  double unit_ = 1;
  bool absolute_ = true;
  bool absolute_centres_ = false;
  std::optional<int> motion_{};
  bool motion_is_hidden_ = false;
};

}  // namespace tmcl::plan::path_file::gcode

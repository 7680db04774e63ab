/// How fast movements of G-code are.
#pragma once

#include <optional>

#include "motion/path/gcode_block.hpp"

namespace tmcl::plan::path_file::gcode {

/// F is of what moves: mm or degrees.
class Feeds {
 public:
  /// G93, G94 or G95, in tenths.
  void set_mode(int code);
  /// F of a line, or that it has none. `unit`: mm of the program's unit.
  Part<void> take(const std::optional<Word>& feed, double unit);
  void set_spindle(double turns_a_minute) { spindle_ = turns_a_minute; }

  /// Of a movement by G1, G2 or G3 that stands there, in mm or degrees a second. `linear`: its
  /// length is in mm.
  Part<double> of(int motion, std::size_t column, bool linear, double length) const;

 private:
  int mode_ = 940;
  std::optional<double> linear_{};   ///< A minute, or a turn after G95.
  std::optional<double> angular_{};  ///< The same of degrees.
  std::optional<double> of_line_{};  ///< After G93; a minute.
  double spindle_ = 0;               ///< Turns a minute.
};

}  // namespace tmcl::plan::path_file::gcode

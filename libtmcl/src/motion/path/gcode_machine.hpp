/// What a program of G-code does besides moving: it stops, ends, switches, changes tools.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "motion/path/gcode_block.hpp"
#include "motion/path/gcode_path_writer.hpp"
#include "motion/path/gcode_report.hpp"

namespace tmcl::plan::path_file::gcode {

/// By M, S and T.
class Machine {
 public:
  /// `words`: as in GcodeSetup.
  Machine(const std::bitset<10>& words, Report& report, PathWriter& path)
      : words_(words), report_(report), path_(path) {}

  void take(const Block& block);
  /// What is done behind the movement of the line.
  void end_line();
  /// At the end of the program, as M2 has it.
  void switch_off();

  bool has_ended() const { return has_ended_; }
  /// An M word of the line that was skipped may mean what its other words are.
  bool hides_words() const { return hides_words_; }
  std::optional<double> tool_in_use() const { return tool_in_use_; }

 private:
  void take_m(const Word& m);
  void take_switch(std::uint8_t word, std::size_t column);
  void take_tool(const Block& block);

  std::bitset<10> words_;
  Report& report_;
  PathWriter& path_;
  bool has_ended_ = false;
  bool hides_words_ = false;
  bool stands_ = false;                 ///< Behind the movement of this line.
  std::optional<std::uint8_t> stop_{};  ///< Why: M0, which waits.
  bool spindle_is_on_ = false;          ///< Switched on by a word that is carried out.
  bool coolant_is_on_ = false;
  std::optional<double> tool_chosen_{};  ///< By T.
  std::optional<double> tool_in_use_{};  ///< By M6.
};

}  // namespace tmcl::plan::path_file::gcode

/// What the G words of a line ask for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "motion/path/gcode_block.hpp"

namespace tmcl::plan::path_file::gcode {

/// Of one of these a line has one code at most.
enum class Group : std::uint8_t {
  motion,
  end_of_cycles,
  once,  ///< What is carried out on its line alone.
  plane,
  unit,
  distance,
  centres,
  feed,
  tool_radius,
  tool_length,
  system,
  corners,
  count
};

/// A code in tenths, so that G92.1 is 921.
class Codes {
 public:
  explicit Codes(const Block& block);

  const std::vector<Wrong>& wrongs() const { return wrongs_; }
  std::optional<int> of(Group group) const { return codes_[static_cast<std::size_t>(group)]; }
  bool are(Group group, int tenths) const { return of(group) == tenths; }
  /// Where the code of this group stands.
  std::size_t column_of(Group group) const { return columns_[static_cast<std::size_t>(group)]; }
  /// Whether G43.1, or the code of the group `once`, says what the axes of the line mean.
  bool take_axes() const;
  bool has_unknown() const { return !wrongs_.empty(); }
  /// A code that is not known may mean what the axes of its line are.
  bool hide_words() const { return hide_words_; }
  /// Such a code says also how axes move from there on.
  bool hide_motion() const { return hide_motion_; }

 private:
  void add(const Word& word);
  void add_unknown(const Word& word, int tenths);
  bool once_takes_axes() const;
  void check_together();
  void exclude(Group one, Group other, const std::string& what);

  std::array<std::optional<int>, static_cast<std::size_t>(Group::count)> codes_{};
  std::array<std::size_t, static_cast<std::size_t>(Group::count)> columns_{};
  std::vector<Wrong> wrongs_;
  bool hide_words_ = false;
  bool hide_motion_ = false;
};

}  // namespace tmcl::plan::path_file::gcode

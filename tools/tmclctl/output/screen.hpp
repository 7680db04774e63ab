/// What a stream can show.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace tmclctl {

constexpr int default_width = 80;
constexpr int least_width = 40;

struct Screen {
  bool terminal = false;  ///< Lines can be redrawn.
  bool colour = false;
  bool utf8 = false;
  int width = default_width;  ///< In columns; at least least_width.
};

/// What lies behind a descriptor, and what NO_COLOR, COLUMNS and the locale say.
Screen screen_of(int descriptor);

/// How tables are shown.
struct TableStyle {
  bool wide = false;  ///< Lines may be longer than the terminal.
  bool tsv = false;   ///< For programs: a tab between two cells, and nothing is cut.
  std::vector<std::string> columns{};  ///< These, in this order; empty: all.
};

/// Where a verb writes, and in which form.
struct Output {
  std::ostream& out;
  std::ostream& err;
  Screen out_screen;
  Screen err_screen;
  bool json = false;
  TableStyle tables{};
  std::string gateway{};  ///< What options_of says, for commands that are proposed.
};

}  // namespace tmclctl

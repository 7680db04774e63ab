/// One line on the terminal that is drawn again and again; nothing at all where there is no
/// terminal.
#pragma once

#include <string>
#include <string_view>

#include "screen.hpp"
#include "tmcl/clock.hpp"

namespace tmclctl {

class ProgressLine {
 public:
  explicit ProgressLine(Output& output);
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  bool visible() const { return visible_; }
  const Screen& screen() const { return output_.err_screen; }
  /// Cut to the screen's width; left out when the line was drawn just before.
  void show(std::string_view text);
  void clear();

 private:
  Output& output_;
  bool visible_;
  bool drawn_ = false;
  tmcl::TimePoint drawn_at_{};
};

/// `fraction` of a bar of `width` columns; in eighths of a column where the screen can show that.
std::string bar(double fraction, int width, bool utf8);
/// Columns of a bar, unless the width of the terminal decides.
constexpr int usual_bar_width = 30;

}  // namespace tmclctl

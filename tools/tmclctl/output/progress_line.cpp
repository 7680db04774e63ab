#include "progress_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tmclctl {
namespace {

// Slow consoles must not hold up what is measured.
constexpr auto redraw_interval = std::chrono::milliseconds(50);

// Columns, not bytes: everything that is shown here is one column wide.
std::string_view cut(std::string_view text, int width) {
  int columns = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins_character = (static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U;
    if (begins_character && columns++ == width) return text.substr(0, i);
  }
  return text;
}

}  // namespace

ProgressLine::ProgressLine(Output& output)
    : output_(output), visible_(output.err_screen.terminal && !output.json) {}

void ProgressLine::show(std::string_view text) {
  const auto now = tmcl::RealClock{}.now();
  if (!visible_ || (drawn_ && now - drawn_at_ < redraw_interval)) return;
  drawn_at_ = now;
  // The last column stays empty, because some terminals wrap when it is written.
  output_.err << '\r' << cut(text, output_.err_screen.width - 1) << "\x1b[K" << std::flush;
  drawn_ = true;
}

void ProgressLine::clear() {
  if (drawn_) output_.err << "\r\x1b[K" << std::flush;
  drawn_ = false;
}

std::string bar(double fraction, int width, bool utf8) {
  static constexpr std::array<std::string_view, 8> eighths{" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int steps = utf8 ? 8 : 1;
  const int filled = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * width * steps));
  std::string text;
  for (int i = 0; i < width; ++i) {
    const int here = std::clamp(filled - i * steps, 0, steps);
    if (here == steps) {
      text += utf8 ? "█" : "#";
    } else {
      text += utf8 ? eighths[static_cast<std::size_t>(here)] : ".";
    }
  }
  return text;
}

}  // namespace tmclctl

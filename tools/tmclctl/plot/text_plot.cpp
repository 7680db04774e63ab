#include "plot/text_plot.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "plot/canvas.hpp"
#include "plot/scale.hpp"

namespace tmclctl::plot {
namespace {

constexpr int panel_rows = 9;
constexpr int text_value_ticks = 4;
constexpr int columns_per_time_tick = 12;

struct Strokes {
  const char* wall;
  const char* tick;
  const char* corner;
  const char* floor;
  const char* floor_tick;
  const char* mark;
};
constexpr Strokes lines{"│", "┤", "└", "─", "┬", "╷"};
constexpr Strokes ascii_lines{"|", "+", "+", "-", "+", "|"};

constexpr const char* curve_colours[] = {"36", "33", "32", "35"};
constexpr const char* frame_colour = "2";

int dot_of(double fraction, int dots) {
  return static_cast<int>(std::lround(fraction * (dots - 1)));
}

class TextPanel {
 public:
  TextPanel(const Curve& curve, const Scale& time, const Screen& screen, int label_width)
      : time_(time),
        values_(all_values(curve), text_value_ticks),
        screen_(screen),
        label_width_(label_width),
        canvas_(std::min(screen.width, widest_plot) - label_width - 2, panel_rows, screen.utf8) {
    draw(curve);
    for (const double tick : values_.ticks()) {
      const int dots_down = canvas_.height() / canvas_.rows();
      labels_.emplace(y_of(tick) / dots_down, values_.label(tick));
    }
  }

  std::string text(const char* colour) const {
    std::string text;
    for (int row = 0; row < panel_rows; ++row) {
      const auto label = labels_.find(row);
      const bool labelled = label != labels_.end();
      text += fmt::format("{:>{}} ", labelled ? label->second : "", label_width_);
      text += coloured(labelled ? strokes().tick : strokes().wall, frame_colour);
      text += coloured(canvas_.row(row), colour) + '\n';
    }
    return text + floor();
  }

  /// A stroke for each mark, and what it says where there is room before the next.
  std::string mark_labels(const std::vector<Mark>& marks) const {
    std::string text;
    std::size_t end = 0;
    for (std::size_t i = 0; i < marks.size(); ++i) {
      const auto begin = place_of(marks[i].time);
      const bool hides_next = i + 1 < marks.size() && place_of(marks[i + 1].time) == begin;
      if (begin < end || hides_next) continue;
      text += std::string(begin - end, ' ') + strokes().mark;
      end = begin + 1;
      const auto room = i + 1 < marks.size() ? place_of(marks[i + 1].time) : full_width();
      if (end + marks[i].label.size() >= room) continue;
      text += marks[i].label;
      end += marks[i].label.size();
    }
    return text + '\n';
  }

  /// The times under the floor.
  std::string time_labels(const std::string& unit) const {
    std::string text;
    for (const double tick : time_.ticks()) {
      const auto label = time_.label(tick);
      const auto middle = place_of(tick);
      const auto begin = middle - std::min(middle, label.size() / 2);
      // The last one leaves room for the unit.
      if (begin < text.size() || begin + label.size() + 1 + unit.size() > full_width()) continue;
      text += std::string(begin - text.size(), ' ') + label + ' ';
    }
    return text + unit + '\n';
  }

 private:
  const Strokes& strokes() const { return screen_.utf8 ? lines : ascii_lines; }
  std::size_t full_width() const {
    return static_cast<std::size_t>(label_width_ + 2 + canvas_.columns());
  }
  int x_of(double time) const { return dot_of(time_.fraction(time), canvas_.width()); }
  int y_of(double value) const { return dot_of(1 - values_.fraction(value), canvas_.height()); }
  int column_of(double time) const { return x_of(time) * canvas_.columns() / canvas_.width(); }
  std::size_t place_of(double time) const {
    return static_cast<std::size_t>(label_width_ + 2 + column_of(time));
  }

  void draw(const Curve& curve) {
    draw(curve.times, curve.values, false);
    for (const auto& other : curve.overlays) draw(other.times, other.values, other.dotted);
  }
  void draw(const std::vector<double>& times, const std::vector<double>& values, bool dotted) {
    constexpr int dots_of_a_gap = 3;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (dotted && x_of(times[i]) / dots_of_a_gap % 2 == 1) continue;
      const auto before = i == 0 || dotted ? i : i - 1;
      canvas_.line(x_of(times[before]), y_of(values[before]), x_of(times[i]), y_of(values[i]));
    }
  }

  std::string floor() const {
    std::string text = strokes().corner;
    for (int column = 0; column < canvas_.columns(); ++column) {
      const auto is_here = [&](double tick) { return column_of(tick) == column; };
      text += std::ranges::any_of(time_.ticks(), is_here) ? strokes().floor_tick : strokes().floor;
    }
    return std::string(static_cast<std::size_t>(label_width_ + 1), ' ') +
           coloured(text, frame_colour) + '\n';
  }

  std::string coloured(const std::string& text, const char* colour) const {
    return screen_.colour && !text.empty() ? fmt::format("\x1b[{}m{}\x1b[0m", colour, text) : text;
  }

  const Scale& time_;
  Scale values_;
  const Screen& screen_;
  int label_width_;
  Canvas canvas_;
  std::map<int, std::string> labels_;
};

int label_width(const Curve& curve) {
  const Scale scale(all_values(curve), text_value_ticks);
  std::size_t width = 0;
  for (const double tick : scale.ticks()) width = std::max(width, scale.label(tick).size());
  return static_cast<int>(width);
}

std::string heading(const Curve& curve, int indent) {
  return fmt::format("{:{}}{} [{}]\n", "", indent, curve.name, curve.unit);
}

}  // namespace

std::string to_text(const Picture& picture, const Screen& screen) {
  int labels = 0;
  for (const auto& curve : picture.curves) labels = std::max(labels, label_width(curve));
  const int columns = std::min(screen.width, widest_plot);
  const Scale time(all_times(picture.curves.front()), std::max(2, columns / columns_per_time_tick));
  auto text = picture.title + "\n\n";
  for (std::size_t i = 0; i < picture.curves.size(); ++i) {
    const auto& curve = picture.curves[i];
    const TextPanel panel(curve, time, screen, labels);
    text += heading(curve, labels + 2);
    if (i == 0 && !picture.marks.empty()) text += panel.mark_labels(picture.marks);
    text += panel.text(curve_colours[i % std::size(curve_colours)]);
    if (&curve == &picture.curves.back()) text += panel.time_labels(picture.time_unit);
  }
  return text;
}

std::string to_text(const Recording& recording, const Screen& screen) {
  return to_text(picture_of(recording), screen);
}

}  // namespace tmclctl::plot

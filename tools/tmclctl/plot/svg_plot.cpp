#include "plot/svg_plot.hpp"

#include <iterator>

#include <fmt/format.h>

#include "plot/scale.hpp"

namespace tmclctl::plot {
namespace {

constexpr double picture_width = 860;
constexpr double picture_height = 540;
constexpr double left = 92;
constexpr double right = 24;
constexpr double panel_width = picture_width - left - right;
constexpr double panel_height = 185;
constexpr double first_panel_top = 64;
constexpr double second_panel_top = 299;
// The curve keeps clear of the frame.
constexpr double padding = 8;
constexpr int value_ticks = 5;
constexpr int time_ticks = 8;

// Greys and colours of middle brightness: about as far from white as from black.
constexpr const char* style =
    "  <style>\n"
    "    text { font: 12px 'DejaVu Sans', 'Segoe UI', Helvetica, Arial, sans-serif; fill: #787878 "
    "}\n"
    "    .title { font-size: 15px; font-weight: bold }\n"
    "    .name { font-size: 13px; font-weight: bold }\n"
    "    .value { text-anchor: end }\n"
    "    .time { text-anchor: middle }\n"
    "    .frame { fill: none; stroke: #808080; stroke-width: 1 }\n"
    "    .grid { stroke: #808080; stroke-opacity: 0.3; stroke-width: 1 }\n"
    "    .curve { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round }\n"
    "    .position { stroke: #2e86de }\n"
    "    .velocity { stroke: #d9730d }\n"
    "    text.position { fill: #2e86de; stroke: none }\n"
    "    text.velocity { fill: #d9730d; stroke: none }\n"
    "  </style>\n";

class Panel {
 public:
  Panel(const Curve& curve, const Scale& time, double top)
      : curve_(curve), time_(time), values_(curve.values, value_ticks), top_(top) {}

  std::string text() const { return frame() + value_axis() + time_grid() + name() + polyline(); }

  /// The times under the frame.
  std::string time_labels(const std::string& unit) const {
    std::string text;
    const double bottom = top_ + panel_height;
    for (const double tick : time_.ticks()) {
      text += fmt::format("  <text class=\"time\" x=\"{:.1f}\" y=\"{}\">{}</text>\n", x_of(tick),
                          bottom + 18, time_.label(tick));
    }
    return text + fmt::format("  <text class=\"time\" x=\"{}\" y=\"{}\">time [{}]</text>\n",
                              left + panel_width / 2, bottom + 38, unit);
  }

 private:
  double x_of(double time) const {
    return left + padding + time_.fraction(time) * (panel_width - 2 * padding);
  }
  double y_of(double value) const {
    return top_ + padding + (1 - values_.fraction(value)) * (panel_height - 2 * padding);
  }

  std::string frame() const {
    return fmt::format("  <rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                       left, top_, panel_width, panel_height);
  }

  std::string name() const {
    return fmt::format("  <text class=\"name {}\" x=\"{}\" y=\"{}\">{} [{}]</text>\n", curve_.name,
                       left, top_ - 8, curve_.name, curve_.unit);
  }

  std::string value_axis() const {
    std::string text;
    for (const double tick : values_.ticks()) {
      const double y = y_of(tick);
      text +=
          fmt::format("  <line class=\"grid\" x1=\"{}\" y1=\"{:.1f}\" x2=\"{}\" y2=\"{:.1f}\"/>\n",
                      left, y, left + panel_width, y);
      text += fmt::format("  <text class=\"value\" x=\"{}\" y=\"{:.1f}\">{}</text>\n", left - 8,
                          y + 4, values_.label(tick));
    }
    return text;
  }

  std::string time_grid() const {
    std::string text;
    for (const double tick : time_.ticks()) {
      const double x = x_of(tick);
      text +=
          fmt::format("  <line class=\"grid\" x1=\"{:.1f}\" y1=\"{}\" x2=\"{:.1f}\" y2=\"{}\"/>\n",
                      x, top_, x, top_ + panel_height);
    }
    return text;
  }

  std::string polyline() const {
    std::string points;
    for (std::size_t i = 0; i < curve_.values.size(); ++i) {
      fmt::format_to(std::back_inserter(points), "{}{:.2f},{:.2f}", i == 0 ? "" : " ",
                     x_of(curve_.times[i]), y_of(curve_.values[i]));
    }
    return fmt::format("  <polyline class=\"curve {}\" points=\"{}\"/>\n", curve_.name, points);
  }

  const Curve& curve_;
  const Scale& time_;
  Scale values_;
  double top_;
};

}  // namespace

std::string escape_xml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '>': escaped += "&gt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\'': escaped += "&apos;"; break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) escaped += c;
    }
  }
  return escaped;
}

std::string to_svg(const Recording& recording) {
  const auto position = position_curve(recording);
  const auto velocity = velocity_curve(recording);
  const Scale time(position.times, time_ticks);
  const Panel lower(velocity, time, second_panel_top);
  const auto title = escape_xml(summary(recording));
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 "
             "{0} {1}\" "
             "role=\"img\">\n  <title>{2}</title>\n",
             picture_width, picture_height, title) +
         style + fmt::format("  <text class=\"title\" x=\"{}\" y=\"26\">{}</text>\n", left, title) +
         Panel(position, time, first_panel_top).text() + lower.text() +
         lower.time_labels(recording.time_unit) + "</svg>\n";
}

}  // namespace tmclctl::plot

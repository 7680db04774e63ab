#include "plot/svg_plot.hpp"

#include <array>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "plot/scale.hpp"
#include "plot/svg_document.hpp"

namespace tmclctl::plot {
namespace {

constexpr double picture_width = 860;
constexpr double plot_left = 92;
constexpr double plot_right = 24;
constexpr double panel_width = picture_width - plot_left - plot_right;
constexpr double panel_height = 185;
constexpr double below_title = 64;
constexpr double below_mark_labels = 18;
constexpr double panel_distance = 235;
constexpr double below_panels = 56;  // the times
// The curve keeps clear of the frame.
constexpr double padding = 8;
// As far from white as from black, and not those of the curves.
constexpr std::array<const char*, most_overlays> overlay_colours{"#c8413b", "#7a8b2a", "#b04f8f",
                                                                 "#808080"};
constexpr int value_ticks = 5;
constexpr int time_ticks = 8;

class Panel {
 public:
  Panel(const Curve& curve, const Scale& time, double top)
      : curve_(curve), time_(time), values_(all_values(curve), value_ticks), top_(top) {}

  std::string text() const {
    auto text = frame() + value_axis() + time_grid() + name();
    text += polyline(curve_.times, curve_.values, "class=\"curve " + colour() + '"');
    if (!curve_.planned.empty())
      text += polyline(curve_.times, curve_.planned, "class=\"curve planned\"");
    for (std::size_t i = 0; i < curve_.overlays.size(); ++i) {
      const auto& other = curve_.overlays[i];
      text += polyline(other.times, other.values,
                       fmt::format("class=\"curve\" stroke=\"{}\"{}", overlay_colours.at(i),
                                   other.dotted ? " stroke-dasharray=\"2 5\"" : ""));
    }
    return text;
  }

  std::string marks(const std::vector<Mark>& marks) const {
    std::string text;
    for (const auto& mark : marks) {
      text += fmt::format(
          "  <line class=\"mark\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\"/>\n",
          x_of(mark.time), top_, top_ + panel_height);
    }
    return text;
  }

  /// What the marks say, above the name, where there is room for it.
  std::string mark_labels(const std::vector<Mark>& marks) const {
    constexpr double character_width = 8;
    std::string text;
    double taken_to = 0;
    for (const auto& mark : marks) {
      const double x = x_of(mark.time);
      if (x < taken_to) continue;
      text += fmt::format("  <text x=\"{:.1f}\" y=\"{}\">{}</text>\n", x, top_ - 24,
                          escape_xml(mark.label));
      taken_to = x + character_width * static_cast<double>(mark.label.size());
    }
    return text;
  }

  /// What is drawn with the curve, each in its own colour.
  std::string overlay_labels() const {
    constexpr double character_width = 8;
    double x = plot_left + character_width * static_cast<double>(curve_.name.size() + 16);
    std::string text;
    for (std::size_t i = 0; i < curve_.overlays.size(); ++i) {
      const auto& label = curve_.overlays[i].label;
      text +=
          fmt::format("  <text class=\"name\" style=\"fill: {}\" x=\"{:.1f}\" y=\"{}\">{}</text>\n",
                      overlay_colours.at(i), x, top_ - 8, escape_xml(label));
      x += character_width * static_cast<double>(label.size() + 2);
    }
    return text;
  }

  /// The times under the frame.
  std::string time_labels(const std::string& unit) const {
    std::string text;
    const double bottom = top_ + panel_height;
    for (const double tick : time_.ticks()) {
      text += fmt::format("  <text class=\"time\" x=\"{:.1f}\" y=\"{}\">{}</text>\n", x_of(tick),
                          bottom + 18, time_.label(tick));
    }
    return text + fmt::format("  <text class=\"time\" x=\"{}\" y=\"{}\">time [{}]</text>\n",
                              plot_left + panel_width / 2, bottom + 38, unit);
  }

 private:
  double x_of(double time) const {
    return plot_left + padding + time_.fraction(time) * (panel_width - 2 * padding);
  }
  double y_of(double value) const {
    return top_ + padding + (1 - values_.fraction(value)) * (panel_height - 2 * padding);
  }

  std::string frame() const {
    return fmt::format("  <rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                       plot_left, top_, panel_width, panel_height);
  }

  const std::string& colour() const {
    return curve_.colour_of.empty() ? curve_.name : curve_.colour_of;
  }
  std::string name() const {
    return fmt::format("  <text class=\"name {}\" x=\"{}\" y=\"{}\">{} [{}]</text>\n", colour(),
                       plot_left, top_ - 8, curve_.name, curve_.unit);
  }

  std::string value_axis() const {
    std::string text;
    for (const double tick : values_.ticks()) {
      const double y = y_of(tick);
      text +=
          fmt::format("  <line class=\"grid\" x1=\"{}\" y1=\"{:.1f}\" x2=\"{}\" y2=\"{:.1f}\"/>\n",
                      plot_left, y, plot_left + panel_width, y);
      text += fmt::format("  <text class=\"value\" x=\"{}\" y=\"{:.1f}\">{}</text>\n",
                          plot_left - 8, y + 4, values_.label(tick));
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

  std::string polyline(std::span<const double> times, std::span<const double> values,
                       const std::string& attributes) const {
    std::string points;
    for (std::size_t i = 0; i < values.size(); ++i) {
      fmt::format_to(std::back_inserter(points), "{}{:.2f},{:.2f}", i == 0 ? "" : " ",
                     x_of(times[i]), y_of(values[i]));
    }
    return fmt::format("  <polyline {} points=\"{}\"/>\n", attributes, points);
  }

  const Curve& curve_;
  const Scale& time_;
  Scale values_;
  double top_;
};

double first_panel(const Picture& picture) {
  return below_title + (picture.marks.empty() ? 0 : below_mark_labels);
}

}  // namespace

double svg_height(const Picture& picture) {
  return first_panel(picture) + panel_distance * static_cast<double>(picture.curves.size() - 1) +
         panel_height + below_panels;
}

std::string to_svg(const Picture& picture) {
  const Scale time(all_times(picture.curves.front()), time_ticks);
  double top = first_panel(picture);
  std::string svg;
  for (const auto& curve : picture.curves) {
    const Panel panel(curve, time, top);
    svg += panel.text() + panel.marks(picture.marks);
    if (&curve == &picture.curves.front())
      svg += panel.mark_labels(picture.marks) + panel.overlay_labels();
    if (&curve == &picture.curves.back()) svg += panel.time_labels(picture.time_unit);
    top += panel_distance;
  }
  return svg_document(picture.title, picture_width, svg_height(picture), plot_left, svg);
}

std::string to_svg(const Recording& recording) { return to_svg(picture_of(recording)); }

}  // namespace tmclctl::plot

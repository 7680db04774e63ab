#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "plot/plane.hpp"
#include "plot/scale.hpp"
#include "plot/svg_document.hpp"
#include "plot/svg_plot.hpp"

namespace tmclctl::plot {
namespace {

constexpr double plane_left = 92;
constexpr double right = 24;
constexpr double top = 68;
constexpr double below = 56;
constexpr double widest = 744;
constexpr double tallest = 520;
constexpr double least_side = 110;
// The way keeps clear of the frame.
constexpr double plane_padding = 14;
constexpr double dots_apart = 4;
constexpr double ring_radius = 8;
constexpr double tick_distance = 90;
constexpr double far_away = 1e9;

/// The values of one direction, and where they lie on the drawing.
class Side {
 public:
  Side(const Plane& plane, std::vector<double> Way::*of) {
    std::vector<double> values = plane.planned.*of;
    for (const auto* way : {&plane.seen, &plane.enlarged})
      values.insert(values.end(), (way->*of).begin(), (way->*of).end());
    const auto [least, greatest] = std::ranges::minmax(values);
    least_ = least;
    span_ = greatest - least;
  }

  double span() const { return span_; }
  double length() const { return length_; }
  void draw(double pixels_a_unit) {
    scale_ = pixels_a_unit;
    length_ = std::max(span_ * scale_ + 2 * plane_padding, least_side);
  }
  /// From the low end.
  double place(double value) const { return length_ / 2 + (value - least_ - span_ / 2) * scale_; }
  Scale ticks() const {
    const double spare = (length_ / 2 - plane_padding) / scale_ - span_ / 2;
    const std::vector<double> ends{least_ - spare, least_ + span_ + spare};
    return {ends, std::max(2, static_cast<int>(length_ / tick_distance))};
  }

 private:
  double least_ = 0;
  double span_ = 0;
  double scale_ = 1;
  double length_ = 0;
};

class Drawing {
 public:
  explicit Drawing(const Plane& plane) : plane_(plane), x_(plane, &Way::x), y_(plane, &Way::y) {
    const double inner_width = widest - 2 * plane_padding;
    const double inner_height = tallest - 2 * plane_padding;
    // The direction with the greater span, by what there is for it, rules; a point has no scale.
    const double span = std::max(x_.span() / inner_width, y_.span() / inner_height);
    const double scale = span > 0 ? 1 / span : 1;
    x_.draw(scale);
    y_.draw(scale);
  }

  static double width() { return plane_left + widest + right; }
  double height() const { return bottom() + below; }
  std::string body() const {
    return frame() + grid() + names() + dots() + line(plane_.enlarged, "difference") +
           line(plane_.planned, planned_kind()) + ring() + legend();
  }

 private:
  double bottom() const { return top + y_.length(); }
  double x_of(double x) const { return plane_left + x_.place(x); }
  double y_of(double y) const { return bottom() - y_.place(y); }

  std::string frame() const {
    return fmt::format(
        "  <rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
        plane_left, top, x_.length(), y_.length());
  }

  std::string grid() const {
    std::string text;
    const auto line = [&](double x0, double y0, double x1, double y1) {
      text += fmt::format(
          "  <line class=\"grid\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", x0,
          y0, x1, y1);
    };
    const auto x_ticks = x_.ticks();
    for (const double tick : x_ticks.ticks()) {
      line(x_of(tick), top, x_of(tick), bottom());
      text += fmt::format("  <text class=\"time\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                          x_of(tick), bottom() + 18, x_ticks.label(tick));
    }
    const auto y_ticks = y_.ticks();
    for (const double tick : y_ticks.ticks()) {
      line(plane_left, y_of(tick), plane_left + x_.length(), y_of(tick));
      text += fmt::format("  <text class=\"value\" x=\"{}\" y=\"{:.1f}\">{}</text>\n",
                          plane_left - 8, y_of(tick) + 4, y_ticks.label(tick));
    }
    return text;
  }

  std::string names() const {
    return fmt::format("  <text class=\"name\" x=\"{}\" y=\"{}\">{}</text>\n", plane_left, top - 10,
                       escape_xml(plane_.y_name)) +
           fmt::format(
               "  <text class=\"name\" style=\"text-anchor: middle\" x=\"{:.1f}\" "
               "y=\"{:.1f}\">{}</text>\n",
               plane_left + x_.length() / 2, bottom() + 40, escape_xml(plane_.x_name));
  }

  std::string line(const Way& way, const char* kind) const {
    std::string points;
    for (std::size_t i = 0; i < way.x.size(); ++i) {
      fmt::format_to(std::back_inserter(points), "{}{:.1f},{:.1f}", i == 0 ? "" : " ",
                     x_of(way.x[i]), y_of(way.y[i]));
    }
    if (points.empty()) return "";
    return fmt::format("  <polyline class=\"curve {}\" points=\"{}\"/>\n", kind, points);
  }
  bool is_compared() const { return !plane_.seen.x.empty(); }
  const char* planned_kind() const { return is_compared() ? "planned" : "position"; }

  // Each is a line without length and with a round end.
  std::string dots() const {
    std::string places;
    double last_x = -far_away;
    double last_y = -far_away;
    for (std::size_t i = 0; i < plane_.seen.x.size(); ++i) {
      const double x = x_of(plane_.seen.x[i]);
      const double y = y_of(plane_.seen.y[i]);
      if (std::hypot(x - last_x, y - last_y) < dots_apart) continue;
      fmt::format_to(std::back_inserter(places), "M{:.1f} {:.1f}h0", x, y);
      last_x = x;
      last_y = y;
    }
    return places.empty() ? "" : dotted(places);
  }

  static std::string dotted(const std::string& places) {
    return fmt::format("  <path class=\"curve position\" style=\"stroke-width: 5\" d=\"{}\"/>\n",
                       places);
  }

  // Its label is where there is more room.
  std::string ring() const {
    if (!plane_.marked) return "";
    const double x = x_of(plane_.marked->x);
    const double y = y_of(plane_.marked->y);
    const bool is_right = x > plane_left + x_.length() / 2;
    const double beside = ring_radius + 5;
    return fmt::format(
        "  <circle class=\"curve difference\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>\n"
        "  <text class=\"difference\" style=\"text-anchor: {}\" x=\"{:.1f}\" "
        "y=\"{:.1f}\">{}</text>\n",
        x, y, ring_radius, is_right ? "end" : "start", is_right ? x - beside : x + beside, y + 4,
        escape_xml(plane_.marked->label));
  }

  /// At the right, above the widest frame.
  std::string legend() const {
    if (!is_compared() && plane_.enlarged.x.empty()) return "";
    std::string text;
    double x = plane_left + widest - 90;
    const auto name = [&](const std::string& what) {
      text +=
          fmt::format("  <text x=\"{}\" y=\"{}\">{}</text>\n", x + 32, top - 10, escape_xml(what));
      x -= 110;
    };
    const auto add = [&](const Way& way, const char* kind, const std::string& what) {
      if (way.x.empty()) return;
      text += fmt::format("  <polyline class=\"curve {}\" points=\"{},{} {},{}\"/>\n", kind, x,
                          top - 14, x + 26, top - 14);
      name(what);
    };
    add(plane_.enlarged, "difference", plane_.enlarged_name);
    add(plane_.planned, planned_kind(), "planned");
    if (!is_compared()) return text;
    text += dotted(fmt::format("M{0} {1}h0M{2} {1}h0M{3} {1}h0", x + 6, top - 14, x + 15, x + 24));
    name("seen");
    return text;
  }

  const Plane& plane_;
  Side x_;
  Side y_;
};

}  // namespace

std::string to_svg(const Plane& plane) {
  const Drawing drawing(plane);
  return svg_document(plane.title, Drawing::width(), drawing.height(), plane_left, drawing.body());
}

std::string to_svg(const Plane& plane, const Picture& picture) {
  const Drawing drawing(plane);
  return svg_document(plane.title, Drawing::width(), drawing.height() + svg_height(picture),
                      plane_left, drawing.body() + svg_part(to_svg(picture), drawing.height()));
}

}  // namespace tmclctl::plot

#include "plot/path_drawing.hpp"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "plot/svg_document.hpp"
#include "plot/svg_plot.hpp"

namespace tmclctl::plot {
namespace {

constexpr double picture_width = 860;
constexpr double side = 560;
constexpr double top = 48;
constexpr double left = 150;
constexpr double below = 56;
constexpr int time_panel_height = 235;
constexpr int around_panels = 140;

}  // namespace

std::string to_svg(const Drawing& drawing, const Picture& picture) {
  const auto [least_x, greatest_x] = std::ranges::minmax(drawing.x);
  const auto [least_y, greatest_y] = std::ranges::minmax(drawing.y);
  const double extent = std::max({greatest_x - least_x, greatest_y - least_y, 1e-12});
  std::string points;
  for (std::size_t i = 0; i < drawing.x.size(); ++i) {
    fmt::format_to(std::back_inserter(points), "{}{:.2f},{:.2f}", i == 0 ? "" : " ",
                   left + (drawing.x[i] - least_x) / extent * side,
                   top + side - (drawing.y[i] - least_y) / extent * side);
  }
  const double height = top + side + below;
  const auto curves = static_cast<int>(picture.curves.size());
  auto body =
      fmt::format("  <rect class=\"frame\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\n",
                  left - 8, top - 8, side + 16, side + 16);
  body += fmt::format("  <polyline class=\"curve position path\" points=\"{}\"/>\n", points);
  body +=
      fmt::format("  <text x=\"{}\" y=\"{}\">{}: {:.6g} to {:.6g}, {}: {:.6g} to {:.6g}</text>\n",
                  left, top + side + 32, escape_xml(drawing.across), least_x, greatest_x,
                  escape_xml(drawing.upward), least_y, greatest_y);
  // Its style holds for all of the document.
  auto inner = to_svg(picture);
  inner.replace(0, 4, fmt::format("<svg y=\"{}\"", height));
  return svg_document(drawing.title, picture_width,
                      height + curves * time_panel_height + around_panels, left, body + inner);
}

}  // namespace tmclctl::plot

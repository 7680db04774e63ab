#include "plot/svg_document.hpp"

#include <string_view>

#include <fmt/format.h>

namespace tmclctl::plot {
namespace {

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
    "    .acceleration { stroke: #1f9d55 }\n"
    "    .jerk { stroke: #a35bd0 }\n"
    "    .difference { stroke: #c8413b }\n"
    "    .planned { stroke-dasharray: 7 5; stroke: #808080 }\n"
    "    .mark { stroke: #808080; stroke-dasharray: 4 3; stroke-width: 1 }\n"
    "    text.position { fill: #2e86de; stroke: none }\n"
    "    text.velocity { fill: #d9730d; stroke: none }\n"
    "    text.acceleration { fill: #1f9d55; stroke: none }\n"
    "    text.jerk { fill: #a35bd0; stroke: none }\n"
    "    text.difference { fill: #c8413b; stroke: none }\n"
    "  </style>\n";

constexpr std::size_t most_characters_of_a_line = 72;

std::string title_line(const std::string& text, double left, double y) {
  return fmt::format("  <text class=\"title\" x=\"{}\" y=\"{}\">{}</text>\n", left, y,
                     escape_xml(text));
}

// On two lines if it is long, and says two things.
std::string title_lines(const std::string& title, double left) {
  const auto end = title.find("; ");
  if (title.size() <= most_characters_of_a_line || end == std::string::npos)
    return title_line(title, left, 26);
  return title_line(title.substr(0, end), left, 18) + title_line(title.substr(end + 2), left, 36);
}

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

std::string svg_document(const std::string& title, double width, double height, double left,
                         const std::string& body) {
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 "
             "{0} {1}\" role=\"img\">\n  <title>{2}</title>\n",
             width, height, escape_xml(title)) +
         style + title_lines(title, left) + body + "</svg>\n";
}

std::string svg_part(std::string document, double top) {
  constexpr std::string_view opening = "<svg";
  return document.insert(opening.size(), fmt::format(" y=\"{}\"", top));
}

}  // namespace tmclctl::plot

/// What all SVG pictures have in common.
#pragma once

#include <string>

namespace tmclctl::plot {

/// With &, <, >, " and ' replaced, and without what XML does not allow at all.
std::string escape_xml(const std::string& text);

/// A document that stands alone, with a title that begins at `left`; its colours can be read on
/// white and on black.
std::string svg_document(const std::string& title, double width, double height, double left,
                         const std::string& body);
/// A document as a part of another one, so far below its top.
std::string svg_part(std::string document, double top);

}  // namespace tmclctl::plot

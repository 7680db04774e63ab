/// What is said of a path before it is passed.
#pragma once

#include <boost/json/object.hpp>

#include "path/path_source.hpp"

namespace tmclctl::path {

boost::json::object to_json(const Source& source, const tmcl::plan::Course& course);
void print(const Source& source, const tmcl::plan::Course& course, Output& output);
/// Without a name nothing is drawn.
Attempt<void> draw(const std::string& svg_path, const Source& source,
                   const tmcl::plan::Course& course);

}  // namespace tmclctl::path

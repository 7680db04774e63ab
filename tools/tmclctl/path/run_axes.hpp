/// The axes that a path is run on, as a target knows them.
#pragma once

#include <string>
#include <vector>

#include "path/path_source.hpp"
#include "target.hpp"

namespace tmclctl::path {

/// In the order of the file's axes. Errors: axes that were not
/// chosen or are not in the file; what is not known of an axis; an axis whose unit is not the
/// file's, that moves, or that may not do what this mode needs.
Attempt<std::vector<tmcl::plan::PathAxis>> read_axes(
    const Source& source, const std::vector<tmcl::plan::PathChoice>& choices,
    const tmcl::plan::PathRequest& request, Target& target);

std::vector<std::string> names_of(const std::vector<tmcl::plan::PathAxis>& axes);
Failure impossible(std::string name, std::string message, std::string hint = {});

}  // namespace tmclctl::path

/// A path by the steps of its axes, where a table corrects those.
#pragma once

#include <memory>
#include <span>
#include <string>

#include <tl/expected.hpp>

#include "tmcl/correction.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan {

/// In the order of the path's axes; null for one that has none.
using Corrections = std::span<const std::shared_ptr<const Correction>>;

/// Lines are divided where an axis passes a row of its table: between two rows, a straight line is
/// one by the steps as well. The rows of a table with times are moved, and not divided. `path` has
/// no arcs. Errors: a sentence, if it becomes longer than most_elements.
tl::expected<path_file::Path, std::string> as_counted(path_file::Path path,
                                                      Corrections corrections);

}  // namespace tmcl::plan

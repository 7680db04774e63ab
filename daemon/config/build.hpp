/// What the sections mean together: names that refer to each other, links, ranges that depend on
/// the kind of link.
#pragma once

#include <span>
#include <vector>

#include "config/config.hpp"
#include "config/section.hpp"

namespace tmcld {

/// Appends what is wrong to `problems`; what it returns can be relied on only if there are none.
/// Sections that lack a required key are left out without a further word.
Config build_config(std::span<const ConfigSection> sections, tmcl::TextProblems& problems);

}  // namespace tmcld

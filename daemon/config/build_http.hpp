/// What the section [http] means.
#pragma once

#include <vector>

#include "config/http_config.hpp"
#include "config/section.hpp"

namespace tmcld {

/// Appends what is wrong to `problems`. That files can be read is checked when they are opened.
HttpConfig build_http(const ConfigSection& section, tmcl::TextProblems& problems);

}  // namespace tmcld

/// A file about what was measured of a module, as `tmclctl verify --report` writes it.
#pragma once

#include <string>

#include <tl/expected.hpp>

#include "config/config.hpp"

namespace tmcld {

/// What of it a twin can take. The error is a sentence that begins with name and line, and names
/// the nearest key or word.
tl::expected<MeasuredModule, std::string> read_measured_module(const std::string& path);

}  // namespace tmcld

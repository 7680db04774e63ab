/// How much of a text that describes movements is read.
#pragma once

#include <cstddef>

namespace tmcl::plan {

/// A text with more is refused.
constexpr std::size_t most_text_lines = 1'000'000;
constexpr std::size_t most_text_line_bytes = 1'000;
/// After so many problems the rest of a text is not looked at.
constexpr std::size_t most_text_problems = 20;

}  // namespace tmcl::plan

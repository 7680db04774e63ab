/// What is wrong with a text that describes movements.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tmcl::plan {

struct TextProblem {
  std::size_t line = 0;    ///< From 1.
  std::size_t column = 0;  ///< In bytes, from 1; 0 if it is about the line as a whole.
  std::string message;     ///< Without a full stop, unless a question or suggestion follows.

  bool operator==(const TextProblem&) const = default;
};
using TextProblems = std::vector<TextProblem>;

/// "file:line:column: message"
std::string describe(const TextProblem& problem, const std::string& file);

/// A text with more is refused.
constexpr std::size_t most_text_lines = 1'000'000;
constexpr std::size_t most_text_line_bytes = 1'000;
/// After so many problems the rest of a text is not looked at.
constexpr std::size_t most_text_problems = 20;

}  // namespace tmcl::plan

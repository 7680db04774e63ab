#include "tmcl/text_problem.hpp"

namespace tmcl {

std::string describe(const TextProblem& problem, std::string_view file) {
  std::string text(problem.file.empty() ? file : problem.file);
  if (problem.line != 0) text += ':' + std::to_string(problem.line);
  if (problem.column != 0) text += ':' + std::to_string(problem.column);
  return text + ": " + problem.message;
}

}  // namespace tmcl

#include "tmcl/plan/text_problem.hpp"

#include <fmt/format.h>

namespace tmcl::plan {

std::string describe(const TextProblem& problem, const std::string& file) {
  if (problem.column == 0) return fmt::format("{}:{}: {}", file, problem.line, problem.message);
  return fmt::format("{}:{}:{}: {}", file, problem.line, problem.column, problem.message);
}

}  // namespace tmcl::plan

#include "text_problems.hpp"

#include <fmt/format.h>
#include <boost/json/array.hpp>

namespace tmclctl {
namespace {

boost::json::object to_json(const tmcl::TextProblem& problem) {
  boost::json::object object{
      {"line", problem.line}, {"column", problem.column}, {"message", problem.message}};
  if (problem.file.empty()) return object;
  object["file"] = problem.file;
  object["word"] = problem.word;
  return object;
}

}  // namespace

Error error_from(const std::string& file, const tmcl::TextProblems& problems, std::size_t most,
                 Output& output, const char* name) {
  auto failure = usage_error(
      name, fmt::format("{}{} problem{} in {}", problems.size() < most ? "" : "at least ",
                        problems.size(), problems.size() == 1 ? "" : "s", file));
  boost::json::array list;
  for (const auto& problem : problems) {
    if (!output.json) output.err << describe(problem, file) << '\n';
    list.push_back(to_json(problem));
  }
  failure.subject["problems"] = std::move(list);
  return failure;
}

}  // namespace tmclctl

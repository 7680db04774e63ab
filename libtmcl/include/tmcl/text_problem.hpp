/// What is wrong with a text: a program, a path, firmware.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tmcl {

struct TextProblem {
  std::size_t line = 0;    ///< From 1; 0 if it is about the text as a whole.
  std::size_t column = 0;  ///< In bytes, from 1; 0 if it is about the line or text as a whole.
  std::string message;     ///< Without a full stop, unless a question or suggestion follows.
  std::string word{};      ///< What it is about, printable and perhaps cut short; may be empty.
  std::string file{};      ///< Of a text of several files; else empty.

  bool operator==(const TextProblem&) const = default;
};
using TextProblems = std::vector<TextProblem>;

/// "file:line:column: message". `file`: of a problem that names none.
std::string describe(const TextProblem& problem, std::string_view file = {});

}  // namespace tmcl

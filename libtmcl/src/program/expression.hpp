/// Expressions of constants: what they are worth.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include <tl/expected.hpp>

#include "program/cursor.hpp"
#include "tmcl/text_problem.hpp"

namespace tmcl::program {

/// What is wrong within a line; `at`: offset into it.
inline TextProblem within_line(std::size_t at, std::string word, std::string message) {
  return {0, at + 1, std::move(message), std::move(word)};
}

/// The value of a name, or what is wrong with it.
using Lookup = std::function<tl::expected<std::int64_t, std::string>(std::string_view name)>;

/// All that the cursor has left must be one expression.
tl::expected<std::int64_t, TextProblem> evaluate(Cursor cursor, const Lookup& lookup);

}  // namespace tmcl::program

/// Expressions of constants: what they are worth.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "program/cursor.hpp"

namespace tmcl::program {

/// What is wrong within a line.
struct Fault {
  std::size_t at = 0;  ///< Offset into the line.
  std::string word;
  std::string message;
};

/// The value of a name, or what is wrong with it.
using Lookup = std::function<tl::expected<std::int64_t, std::string>(std::string_view name)>;

/// All that the cursor has left must be one expression.
tl::expected<std::int64_t, Fault> evaluate(Cursor cursor, const Lookup& lookup);

}  // namespace tmcl::program

/// A copy of a result for each of several who wait for it.
#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "tmcl/error.hpp"

namespace tmcl {

/// The copy constructor of tl::expected is noexcept: it ends the program where there is no memory
/// for what it copies. This one throws.
template <class T>
Result<T> copy_of(const Result<T>& result) {
  if (!result) {
    auto error = result.error();
    return tl::unexpected(std::move(error));
  }
  if constexpr (std::is_void_v<T>) {
    return {};
  } else {
    auto value = *result;
    return Result<T>(std::move(value));
  }
}
template <class T>
std::optional<Result<T>> copy_of(const std::optional<Result<T>>& result) {
  if (!result) return std::nullopt;
  return std::optional(copy_of(*result));
}

}  // namespace tmcl

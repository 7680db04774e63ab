/// Numbers of a call that have bounds; those of integers are in their structs.
#pragma once

#include <string_view>

#include <fmt/format.h>

#include "api/task.hpp"

namespace tmcld {

/// Between two bounds; NaN is not.
inline Task<double> number_within(std::string_view param, double value, double least,
                                  double greatest) {
  if (value >= least && value <= greatest) co_return value;
  co_return param_error("out_of_range", param,
                        fmt::format("'{}' is {} to {}, not {}", param, least, greatest, value));
}

}  // namespace tmcld

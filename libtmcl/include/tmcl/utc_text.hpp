/// Instants for people and for other programs.
#pragma once

#include <cstddef>
#include <string>

#include "tmcl/clock.hpp"

namespace tmcl {

/// ISO 8601: "2026-11-25T10:12:01.123456Z". `decimals` of a second, 0 to 9; the rest is cut off.
std::string to_text(UtcTime time, std::size_t decimals = 6);

}  // namespace tmcl

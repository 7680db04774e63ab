/// Instants for people and for other programs.
#pragma once

#include <string>

#include "tmcl/clock.hpp"

namespace tmcl {

/// ISO 8601, to the microsecond: "2026-11-25T10:12:01.123456Z".
std::string to_text(UtcTime time);

}  // namespace tmcl

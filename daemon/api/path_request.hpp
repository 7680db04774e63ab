/// What a call about a path asks for.
#pragma once

#include <optional>

#include "api/task.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {

/// Errors: a mode that there is not, or that takes no jerk; a number out of range; a text that is
/// no quantity.
Result<tmcl::plan::PathRequest> request_of(const api::path::OfPath& params);

/// Nothing without a shaper. Errors: one that there is not; no resonance; position mode.
Task<std::optional<tmcl::plan::Shaping>> shaping_of(const api::path::OfPath& params);

/// What is said; nothing: what the text looks like.
Result<std::optional<tmcl::plan::PathFormat>> format_in(const api::path::OfPath& params);

}  // namespace tmcld

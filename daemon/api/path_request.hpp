/// What a call about a path asks for.
#pragma once

#include <string>

#include "api/call.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/plan/path_preparation.hpp"

namespace tmcld {

/// Errors: a mode that there is not, a number out of range, a text that is no quantity.
Lookup<tmcl::plan::PathRequest> request_of(const api::path::OfPath& params);

/// What is said, or what the text looks like.
Lookup<tmcl::plan::PathFormat> format_of(const api::path::OfPath& params, const std::string& text);

}  // namespace tmcld

/// Where the tables of a model's parameters are from.
#pragma once

#include <string_view>

#include "tmcl/model.hpp"

namespace tmcl {

/// The document that the ranges and meanings of its parameters follow. Their numbers are from
/// PyTrinamic's lists on every model.
std::string_view document_of(const Model& model);

}  // namespace tmcl

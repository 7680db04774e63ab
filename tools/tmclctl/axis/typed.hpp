/// Quantities and parameters as they were typed, for the methods that take them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tmcl/api/field.hpp"
#include "tmcl/quantity.hpp"

namespace tmclctl {

using tmcl::AxisUnits;
using tmcl::Quantity;

/// A position, a distance or a velocity.
struct Typed {
  std::string text;  ///< A number with its unit, as it was typed.
  /// A number without one is what the module counts, also on an axis with a unit.
  bool internal = false;

  // A method takes one of two parameters: what a module counts, or a number with its unit; none
  // for an option that was left out.
  std::optional<std::int32_t> counted() const;
  std::optional<tmcl::api::Amount> amount() const;
};

/// A number does not travel as text.
tmcl::api::NameOrNumber name_or_number(const std::string& text);

}  // namespace tmclctl

/// An axis that need not be there: what it is measured in, and what a quantity is to it.
#pragma once

#include "command_line/options.hpp"
#include "output/errors.hpp"
#include "tmcl/quantity.hpp"

namespace tmclctl {

/// With what its module counts when it starts. Errors: a model that is not known; a unit that
/// cannot be called so.
Result<tmcl::AxisUnits> axis_units_of(const verb::OfflineAxis& axis);

/// A quantity as it was typed. A number without a unit is what the module counts: `units` without a
/// scale then.
struct TypedQuantity {
  tmcl::Quantity quantity;
  tmcl::AxisUnits units;
};
Result<TypedQuantity> typed_quantity(const std::string& text, const tmcl::AxisUnits& units);

}  // namespace tmclctl

/// What a unit of an axis is to its motor and to its encoder.
#pragma once

#include <optional>
#include <string>

#include <boost/json/object.hpp>

#include "connection/gateway.hpp"

namespace tmclctl {

/// Nothing for what the axis does not have, or is not known.
struct ScaleFactors {
  std::optional<double> microsteps_per_unit;
  std::optional<double> encoder_counts_per_unit;
};

/// Asks for them where the axis has a unit; what cannot be read is not known.
ScaleFactors scale_factors_of(const std::string& axis, bool has_unit, Context& context);
/// As "microsteps_per_unit" and "encoder_counts_per_unit"; null for nothing.
void add(const ScaleFactors& factors, boost::json::object& document);
/// "-" for nothing.
std::string factor_text(const std::optional<double>& factor);

}  // namespace tmclctl

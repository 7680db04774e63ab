#include "scale_factors.hpp"

#include <fmt/format.h>

#include "module_lists.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/scale_factor.hpp"

namespace tmclctl {
namespace {

boost::json::value value_or_null(const std::optional<double>& factor) {
  return factor ? boost::json::value(*factor) : boost::json::value(nullptr);
}

}  // namespace

ScaleFactors scale_factors_of(const std::string& axis, bool has_unit, Context& context) {
  if (!has_unit) return {};
  const auto units = units_of(axis, context);
  if (!units || !units->has_unit()) return {};
  return {tmcl::microsteps_per_unit(*units->scale), units->encoder_counts_per_unit};
}

void add(const ScaleFactors& factors, boost::json::object& document) {
  document["microsteps_per_unit"] = value_or_null(factors.microsteps_per_unit);
  document["encoder_counts_per_unit"] = value_or_null(factors.encoder_counts_per_unit);
}

std::string factor_text(const std::optional<double>& factor) {
  return factor ? tmcl::plain_number(*factor, 10) : "-";
}

}  // namespace tmclctl

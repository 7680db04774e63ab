#include "gateway/axis/axis_range.hpp"

#include <algorithm>
#include <limits>

namespace tmcld {

tmcl::ValueRange range_of(const GatewayAxis& axis, const tmcl::UserScale& scale) {
  tmcl::ValueRange range{std::numeric_limits<std::int32_t>::min(),
                         std::numeric_limits<std::int32_t>::max()};
  const auto* row = find_parameter(axis.parameters(), tmcl::axis_parameter::target_position);
  if (row != nullptr) range = {row->minimum, row->maximum};
  if (const auto& limits = axis.soft_limits()) {
    const auto within =
        microsteps_within(*limits, axis.unit().empty() ? tmcl::microsteps_scale() : scale);
    range = {std::max(range.least, within.least), std::min(range.greatest, within.greatest)};
  }
  return range;
}

}  // namespace tmcld

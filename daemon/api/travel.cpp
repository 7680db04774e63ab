#include "api/travel.hpp"

#include <algorithm>

namespace tmcld {

Task<Travel> travel_between(GatewayAxis& axis, RawOrQuantity from, RawOrQuantity to) {
  const bool has_from = from.plain || from.amount;
  const bool has_to = to.plain || to.amount;
  if (!has_from && !has_to) co_return Travel{};
  if (has_from != has_to)
    co_return param_error("bad_argument", has_from ? "to" : "from", "'from' and 'to' go together");
  const auto least = co_await must(distance_of(axis, from));
  const auto greatest = co_await must(distance_of(axis, to));
  // An axis may count the other way round.
  const auto [low, high] = std::minmax(least.microsteps.value, greatest.microsteps.value);
  if (low <= 0 && high >= 0 && low < high) co_return Travel{{low, high}};
  co_return param_error("out_of_range", "from",
                        "the axis must be within its travel: 'from' is 0 or less, "
                        "'to' is 0 or more",
                        "both count from where it stands, such as -2mm..2mm");
}

}  // namespace tmcld

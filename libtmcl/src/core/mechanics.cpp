#include "tmcl/mechanics.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace tmcl {
namespace {

// Twelve digits: what is behind them comes from the conversion, not from the user.
std::string number_text(double value) {
  constexpr int digits = 12;
  char buffer[32];
  const auto end =
      std::to_chars(std::begin(buffer), std::end(buffer), value, std::chars_format::general, digits)
          .ptr;
  return {buffer, end};
}

std::int32_t clipped_microsteps(UserPosition position, const UserScale& scale) {
  if (const auto microsteps = to_microsteps(position, scale)) return microsteps->value;
  const bool high = (position.value > 0) != scale.reverse;
  return high ? std::numeric_limits<std::int32_t>::max() : std::numeric_limits<std::int32_t>::min();
}

}  // namespace

double counts_per_unit(const ShaftEncoder& encoder, const UserScale& scale) {
  return encoder.counts_per_revolution() * scale.gear_ratio / scale.units_per_revolution;
}

UserScale encoder_scale(double counts_per_unit, const UserScale& scale) {
  return {scale.unit, 1, scale.reverse, {1, 0}, counts_per_unit};
}

bool is_encoder_position(const ParameterInfo& row) {
  return row.name == "encoder_position" || row.name == "latched_encoder_position";
}

ValueRange microsteps_within(const SoftLimits& limits, const UserScale& scale) {
  const auto [least, greatest] = std::minmax(
      {clipped_microsteps(limits.least, scale), clipped_microsteps(limits.greatest, scale)});
  return {least, greatest};
}

std::string describe(const BeyondLimit& error) {
  return number_text(error.position) + ' ' + error.unit + " is beyond the soft limit of " +
         number_text(error.limit) + ' ' + error.unit;
}

std::optional<BeyondLimit> beyond(const SoftLimits& limits, Microsteps position,
                                  const UserScale& scale) {
  const auto range = microsteps_within(limits, scale);
  if (position.value >= range.least && position.value <= range.greatest) return std::nullopt;
  const bool low = (position.value < range.least) != scale.reverse;
  return BeyondLimit{to_user(position, scale).value,
                     low ? limits.least.value : limits.greatest.value, scale.unit};
}

}  // namespace tmcl

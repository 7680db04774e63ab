#include "tmcl/mechanics.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>

#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl {
namespace {

constexpr std::string_view ramp_mode = "ramp_mode";

// Twelve digits: what is behind them comes from the conversion, not from the user.
std::string rounded_text(double value) { return plain_number(value, 12); }

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

std::optional<ModeParameter> mode_parameter(std::span<const ParameterInfo> table) {
  constexpr std::int32_t velocity_mode = 2;  // of every model that has the parameter
  const auto* row = find_parameter(table, ramp_mode);
  if (row == nullptr) return std::nullopt;
  return ModeParameter{row->number, velocity_mode};
}

ValueRange microsteps_within(const SoftLimits& limits, const UserScale& scale) {
  const auto [least, greatest] = std::minmax(
      {clipped_microsteps(limits.least, scale), clipped_microsteps(limits.greatest, scale)});
  return {least, greatest};
}

std::string describe(const BeyondLimit& error) {
  return rounded_text(error.position) + ' ' + error.unit + " is beyond the soft limit of " +
         rounded_text(error.limit) + ' ' + error.unit;
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

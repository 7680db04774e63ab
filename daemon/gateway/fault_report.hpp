/// What the module of an axis says of itself when it is asked what is wrong.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

/// By name, such as short_to_ground_a: see tmcl/status_flags.hpp. A supply that is too low for any
/// driver is undervoltage.
using Faults = std::vector<std::string_view>;

struct FaultReport {
  Faults flags{};
  std::vector<std::string_view> switches{};  ///< Those that are closed: left, right, home.
  std::optional<double> supply_volts{};      ///< Nothing where it does not tell.
  std::optional<double> temperature_celsius{};

  bool has_flag(std::string_view flag) const;
  /// Those that are of the driver or the supply.
  Faults driver_faults() const;
  bool has_switch(std::string_view name) const;
};

/// "short circuit to ground of coil A, undervoltage"
std::string words_for(const Faults& faults);
/// They are worth a stop or a look: the driver is off, or has no current in a coil. Others only say
/// that this is near.
bool keeps_from_moving(const Faults& faults);

/// The value of a parameter, 0 where the module has none of this name.
/// Errors: those of the exchange, but not a refusal.
tmcl::Script<tmcl::Result<std::int32_t>> read_if_any(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters, std::string_view name);

/// What keeps the driver of the axis from moving its motor, or soon will. Clears nothing.
/// Errors: those of the exchanges, but not refusals.
tmcl::Script<tmcl::Result<Faults>> read_driver_faults(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

/// Reading clears the flags stall and deviation.
/// Errors: those of the exchanges, but not refusals.
tmcl::Script<tmcl::Result<FaultReport>> read_faults(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

}  // namespace tmcld

/// What the module of an axis says of itself when it is asked what is wrong.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "tmcl/address.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/script.hpp"

namespace tmcld {

struct FaultReport {
  std::vector<std::string_view> flags{};     ///< See tmcl/status_flags.hpp.
  std::vector<std::string_view> switches{};  ///< Those that are closed: left, right, home.
  std::optional<double> supply_volts{};      ///< Nothing where it does not tell.
  std::optional<double> temperature_celsius{};

  bool has_flag(std::string_view flag) const;
  bool has_switch(std::string_view name) const;
};

/// The value of a parameter, 0 where the module has none of this name.
/// Errors: those of the exchange, but not a refusal.
tmcl::Script<tmcl::Result<std::int32_t>> read_if_any(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters, std::string_view name);

/// Reading clears the flags stall and deviation.
/// Errors: those of the exchanges, but not refusals.
tmcl::Script<tmcl::Result<FaultReport>> read_faults(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters);

}  // namespace tmcld

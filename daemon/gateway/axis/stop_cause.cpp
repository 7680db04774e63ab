#include "gateway/axis/stop_cause.hpp"

#include "gateway/module/fault_report.hpp"
#include "tmcl/mechanics.hpp"
#include "tmcl/status_flags.hpp"

namespace tmcld {

std::string_view name_of(StopCause cause) {
  switch (cause) {
    case StopCause::stall: return "stall";
    case StopCause::deviation: return "deviation";
    case StopCause::left_limit: return "left_limit";
    case StopCause::right_limit: return "right_limit";
    case StopCause::deadman: return "deadman";
    case StopCause::supply: return "supply";
    case StopCause::client: return "client";
    case StopCause::lease_lost: return "lease_lost";
    case StopCause::search_limit: return "search_limit";
    case StopCause::daemon: return "daemon";
    case StopCause::velocity_mode: return "velocity_mode";
    case StopCause::unknown: return "unknown";
  }
  return {};
}

tmcl::Script<tmcl::Result<StopCause>> find_stop_cause(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters) {
  const auto faults = co_await must(read_faults(axis, parameters));
  if (faults.has_flag(tmcl::status_flag::stall)) co_return StopCause::stall;
  if (faults.has_flag(tmcl::status_flag::deviation)) co_return StopCause::deviation;
  if (faults.has_switch("left")) co_return StopCause::left_limit;
  if (faults.has_switch("right")) co_return StopCause::right_limit;
  const auto mode = co_await must(read_if_any(axis, parameters, "ramp_mode"));
  const auto known = tmcl::mode_parameter(parameters);
  co_return known&& mode == known->velocity ? StopCause::velocity_mode : StopCause::unknown;
}

}  // namespace tmcld

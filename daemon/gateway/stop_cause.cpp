#include "gateway/stop_cause.hpp"

#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

// Of extended_error_flags.
constexpr std::int32_t stalled = 1 << 0;
constexpr std::int32_t deviated = 1 << 1;
// Of ramp_mode.
constexpr std::int32_t velocity_mode = 2;

/// 0 where the module has no such parameter.
tmcl::Script<tmcl::Result<std::int32_t>> read_if_any(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters,
    std::string_view name) {
  const auto* row = find_parameter(parameters, name);
  if (row == nullptr) co_return 0;
  const auto value = co_await tmcl::verbs::get(axis, row->number);
  if (!value && value.error().outcome == tmcl::Outcome::refused) co_return 0;
  co_return value;
}

}  // namespace

std::string_view name_of(StopCause cause) {
  switch (cause) {
    case StopCause::stall: return "stall";
    case StopCause::deviation: return "deviation";
    case StopCause::left_limit: return "left_limit";
    case StopCause::right_limit: return "right_limit";
    case StopCause::supply: return "supply";
    case StopCause::client: return "client";
    case StopCause::lease_lost: return "lease_lost";
    case StopCause::daemon: return "daemon";
    case StopCause::velocity_mode: return "velocity_mode";
    case StopCause::unknown: return "unknown";
  }
  return {};
}

tmcl::Script<tmcl::Result<StopCause>> find_stop_cause(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters) {
  const auto flags = co_await must(read_if_any(axis, parameters, "extended_error_flags"));
  if ((flags & stalled) != 0) co_return StopCause::stall;
  if ((flags & deviated) != 0) co_return StopCause::deviation;
  const auto left = co_await must(read_if_any(axis, parameters, "left_limit_switch"));
  if (left != 0) co_return StopCause::left_limit;
  const auto right = co_await must(read_if_any(axis, parameters, "right_limit_switch"));
  if (right != 0) co_return StopCause::right_limit;
  const auto mode = co_await must(read_if_any(axis, parameters, "ramp_mode"));
  co_return mode == velocity_mode ? StopCause::velocity_mode : StopCause::unknown;
}

}  // namespace tmcld

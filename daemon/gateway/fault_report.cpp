#include "gateway/fault_report.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tmcl/status_flags.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using tmcl::Result;
using tmcl::Script;

// Of the analog inputs. Most modules have both, the manuals say.
constexpr std::uint8_t supply_port = 8;  // in 0.1 V
constexpr std::uint8_t temperature_port = 9;

constexpr auto flag_parameters =
    std::to_array<std::string_view>({"extended_error_flags", "driver_status_flags", "status_word"});
constexpr auto switch_parameters = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"left_limit_switch", "left"}, {"right_limit_switch", "right"}, {"home_switch", "home"}});

Script<Result<std::optional<double>>> read_port(tmcl::ModuleAddress module, std::uint8_t port,
                                                double unit) {
  const auto value = co_await tmcl::verbs::get_io(module, tmcl::IoBank::analog_inputs, port);
  if (value) co_return std::optional(*value * unit);
  if (value.error().outcome != tmcl::Outcome::refused) co_return tl::unexpected(value.error());
  co_return std::optional<double>();
}

}  // namespace

bool FaultReport::has_flag(std::string_view flag) const {
  return std::ranges::find(flags, flag) != flags.end();
}

bool FaultReport::has_switch(std::string_view name) const {
  return std::ranges::find(switches, name) != switches.end();
}

Script<Result<std::int32_t>> read_if_any(tmcl::AxisAddress axis,
                                         std::span<const tmcl::ParameterInfo> parameters,
                                         std::string_view name) {
  const auto* row = find_parameter(parameters, name);
  if (row == nullptr) co_return 0;
  const auto value = co_await tmcl::verbs::get(axis, row->number);
  if (!value && value.error().outcome == tmcl::Outcome::refused) co_return 0;
  co_return value;
}

Script<Result<FaultReport>> read_faults(tmcl::AxisAddress axis,
                                        std::span<const tmcl::ParameterInfo> parameters) {
  FaultReport report;
  for (const auto parameter : flag_parameters) {
    const auto value = co_await must(read_if_any(axis, parameters, parameter));
    for (const auto& flag : tmcl::status_flags(parameter))
      if ((value & flag.bit) != 0) report.flags.push_back(flag.name);
  }
  for (const auto& [parameter, name] : switch_parameters) {
    const auto closed = co_await must(read_if_any(axis, parameters, parameter));
    if (closed != 0) report.switches.push_back(name);
  }
  report.supply_volts = co_await must(read_port(axis.module, supply_port, 0.1));
  report.temperature_celsius = co_await must(read_port(axis.module, temperature_port, 1));
  co_return report;
}

}  // namespace tmcld

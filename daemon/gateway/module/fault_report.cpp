#include "gateway/module/fault_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "tmcl/status_flags.hpp"
#include "tmcl/verbs.hpp"

namespace tmcld {
namespace {

using tmcl::Script;

// Of the analog inputs. Most modules have both, the manuals say.
constexpr std::uint8_t supply_port = 8;  // in 0.1 V
constexpr std::uint8_t temperature_port = 9;

// Below it no driver of these modules works: a TMC249 does so from 7 V on, others from 8 or 9 V.
constexpr double least_supply_volts = 7;
constexpr std::string_view undervoltage = "undervoltage";

constexpr auto driver_parameters =
    std::to_array<std::string_view>({"driver_status_flags", "status_word"});
constexpr auto switch_parameters = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"left_limit_switch", "left"}, {"right_limit_switch", "right"}, {"home_switch", "home"}});

Script<tmcl::Result<std::optional<double>>> read_port(tmcl::ModuleAddress module, std::uint8_t port,
                                                      double unit) {
  const auto value = co_await tmcl::verbs::get_io(module, tmcl::IoBank::analog_inputs, port);
  if (value) co_return std::optional(*value * unit);
  if (value.error().outcome != tmcl::Outcome::refused) co_return tl::unexpected(value.error());
  co_return std::optional<double>();
}

/// Those that are set, into `flags`.
Script<tmcl::Result<void>> read_flags(tmcl::AxisAddress axis,
                                      std::span<const tmcl::ParameterInfo> parameters,
                                      std::string_view parameter, Faults& flags) {
  const auto* row = find_parameter(parameters, parameter);
  if (row == nullptr) co_return tmcl::Result<void>{};
  const auto value = co_await must(read_if_any(axis, parameters, parameter));
  // Another name of it stands for other bits.
  for (const auto& flag : tmcl::status_flags(row->name))
    if ((value & flag.bit) != 0) flags.push_back(flag.name);
  co_return tmcl::Result<void>{};
}

/// What the driver tells, and the supply; its voltage, if that is told.
Script<tmcl::Result<std::optional<double>>> read_driver(
    tmcl::AxisAddress axis, std::span<const tmcl::ParameterInfo> parameters, Faults& flags) {
  for (const auto parameter : driver_parameters)
    co_await must(read_flags(axis, parameters, parameter, flags));
  const auto volts = co_await must(read_port(axis.module, supply_port, 0.1));
  const bool is_told = std::ranges::find(flags, undervoltage) != flags.end();
  if (volts && *volts < least_supply_volts && !is_told) flags.push_back(undervoltage);
  co_return volts;
}

struct Words {
  std::string_view name;
  std::string_view words;
  bool keeps_from_moving;
};
constexpr auto all_words = std::to_array<Words>({
    {"overtemperature", "its driver is too hot, and off", true},
    {"overtemperature_warning", "its driver is nearly too hot", false},
    {"short_to_ground_a", "short to ground of coil A", true},
    {"short_to_ground_b", "short to ground of coil B", true},
    {"open_load_a", "coil A is not connected", true},
    {"open_load_b", "coil B is not connected", true},
    {undervoltage, "its supply is too low", true},
    {"overvoltage", "its supply is too high", true},
    {"i2t_exceeded", "its motor was overloaded for too long", true},
});

}  // namespace

std::string words_for(const Faults& faults) {
  std::string text;
  for (const auto fault : faults) {
    const auto* row = std::ranges::find(all_words, fault, &Words::name);
    text += (text.empty() ? "" : ", ") + std::string(row == all_words.end() ? fault : row->words);
  }
  return text;
}

bool keeps_from_moving(const Faults& faults) {
  return std::ranges::any_of(faults, [](std::string_view fault) {
    const auto* row = std::ranges::find(all_words, fault, &Words::name);
    return row != all_words.end() && row->keeps_from_moving;
  });
}

bool is_open_load(std::string_view fault) { return fault.starts_with("open_load"); }

Faults OpenLoads::judge(DriverReading reading) {
  constexpr int proof = 2;
  std::erase_if(seen_, [&](const auto& one) {
    return std::ranges::find(reading.faults, one.first) == reading.faults.end();
  });
  unproven_.clear();
  std::erase_if(reading.faults, [&](std::string_view fault) {
    if (!is_open_load(fault)) return false;
    auto& seen = seen_[fault];
    if (seen < proof) seen = reading.turns_slowly ? seen + 1 : 0;
    if (seen < proof) unproven_.push_back(fault);
    return seen < proof;
  });
  return std::move(reading.faults);
}

std::vector<std::string_view> driver_flags() {
  std::vector<std::string_view> flags;
  for (const auto& one : all_words) flags.push_back(one.name);
  return flags;
}

Faults FaultReport::driver_faults() const {
  Faults faults;
  std::ranges::copy_if(flags, std::back_inserter(faults), [](std::string_view flag) {
    return std::ranges::find(all_words, flag, &Words::name) != all_words.end();
  });
  return faults;
}

bool FaultReport::has_flag(std::string_view flag) const {
  return std::ranges::find(flags, flag) != flags.end();
}

bool FaultReport::has_switch(std::string_view name) const {
  return std::ranges::find(switches, name) != switches.end();
}

Script<tmcl::Result<std::int32_t>> read_if_any(tmcl::AxisAddress axis,
                                               std::span<const tmcl::ParameterInfo> parameters,
                                               std::string_view name) {
  const auto* row = find_parameter(parameters, name);
  if (row == nullptr) co_return 0;
  auto value = co_await tmcl::verbs::get(axis, row->number);
  if (!value && value.error().outcome == tmcl::Outcome::refused) co_return 0;
  co_return value;
}

Script<tmcl::Result<bool>> turns_slowly(tmcl::AxisAddress axis,
                                        std::span<const tmcl::ParameterInfo> parameters,
                                        std::optional<tmcl::ModuleUnits> units,
                                        std::optional<tmcl::InternalVelocity> velocity) {
  // In full steps a second: a coil has current each way within half a second, and a motor of 200
  // of them to a turn is far from the speed at which it has no current any more.
  constexpr double slowest = 4;
  constexpr double fastest = 400;
  if (!velocity) velocity = {co_await must(read_if_any(axis, parameters, "actual_velocity"))};
  if (velocity->value == 0) co_return false;
  if (!units) co_return true;
  const auto resolution = co_await must(read_if_any(axis, parameters, "microstep_resolution"));
  const double speed = std::abs(velocity->value * units->velocity.value) / std::exp2(resolution);
  co_return speed >= slowest&& speed <= fastest;
}

Script<tmcl::Result<DriverReading>> read_driver(tmcl::AxisAddress axis,
                                                std::span<const tmcl::ParameterInfo> parameters,
                                                std::optional<tmcl::ModuleUnits> units,
                                                std::optional<tmcl::InternalVelocity> velocity) {
  DriverReading reading;
  reading.supply_volts = co_await must(read_driver(axis, parameters, reading.faults));
  if (std::ranges::any_of(reading.faults, is_open_load))
    reading.turns_slowly = co_await must(turns_slowly(axis, parameters, units, velocity));
  co_return reading;
}

Script<tmcl::Result<std::optional<double>>> read_temperature(tmcl::ModuleAddress module) {
  return read_port(module, temperature_port, 1);
}

Script<tmcl::Result<FaultReport>> read_faults(tmcl::AxisAddress axis,
                                              std::span<const tmcl::ParameterInfo> parameters) {
  FaultReport report;
  co_await must(read_flags(axis, parameters, "extended_error_flags", report.flags));
  report.supply_volts = co_await must(read_driver(axis, parameters, report.flags));
  for (const auto& [parameter, name] : switch_parameters) {
    const auto closed = co_await must(read_if_any(axis, parameters, parameter));
    if (closed != 0) report.switches.push_back(name);
  }
  report.temperature_celsius = co_await must(read_temperature(axis.module));
  co_return report;
}

}  // namespace tmcld

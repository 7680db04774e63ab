#include "api/mc1451a_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "api/params.hpp"
#include "api/suggest.hpp"
#include "tmcl/ramp/mc1451a.hpp"

namespace tmcld {
namespace {

using tmcl::api::profile::Curve;
using tmcl::api::profile::Simulate;
using tmcl::api::profile::Simulated;
using tmcl::ramp::Mc1451a;
using tmcl::ramp::Tick;
using Register = Mc1451a::Register;

constexpr std::string_view cycle_name = "cycle_us";
constexpr std::int32_t usual_cycle_us = 1000;
constexpr std::int32_t longest_cycle_us = 1'000'000;
// Parts of a step, of velocities and accelerations.
constexpr double parts_of_a_step = 1 << 16;

/// The chip, and how long its cycle is.
struct Clocked {
  Mc1451a chip;
  double cycle_s = usual_cycle_us * 1e-6;

  double seconds(Tick ticks) const {
    return static_cast<double>(ticks) / Mc1451a::ticks_per_cycle * cycle_s;
  }
  Tick ticks(double seconds) const {
    return static_cast<Tick>(std::llround(seconds / cycle_s * Mc1451a::ticks_per_cycle));
  }
  double speed() const {
    return static_cast<double>(chip.motion().velocity) / parts_of_a_step / cycle_s;
  }
  double acceleration() const {
    return static_cast<double>(chip.motion().acceleration) / parts_of_a_step / cycle_s / cycle_s;
  }
};

Error not_taken(const std::string& name, std::int32_t value, std::int64_t least,
                std::int64_t most) {
  return param_error<&Simulate::values>(
      "out_of_range", fmt::format("an {} does not take {} for parameter {}: it is {}..{}",
                                  mc1451a_name, value, name, least, most));
}

Result<void> write_one(Clocked& clocked, const std::string& name, std::int32_t value) {
  if (name == cycle_name) {
    if (value < 1 || value > longest_cycle_us)
      return tl::unexpected(not_taken(name, value, 1, longest_cycle_us));
    clocked.cycle_s = value * 1e-6;
    return {};
  }
  const auto registers = Mc1451a::registers();
  const auto index = find_register(registers, name);
  if (!index || static_cast<Register>(*index) == Register::position) {
    constexpr std::array names{std::string_view("profile"), std::string_view("velocity"),
                               std::string_view("acceleration"), std::string_view("jerk"),
                               cycle_name};
    return tl::unexpected(param_error<&Simulate::parameters>(
        "unknown_parameter", fmt::format("an {} has no parameter '{}'", mc1451a_name, name),
        suggest(name, names)));
  }
  const auto& info = registers[*index];
  if (clocked.chip.write(static_cast<Register>(*index), value)) return {};
  return tl::unexpected(not_taken(name, value, info.minimum, info.maximum));
}

Result<Clocked> set_up(const Simulate& params) {
  const auto names = params.parameters.value_or(std::vector<std::string>());
  const auto values = params.values.value_or(std::vector<std::int32_t>());
  if (names.size() != values.size()) {
    return tl::unexpected(param_error<&Simulate::values>(
        "bad_argument", "there must be one of 'values' for each of 'parameters'"));
  }
  Clocked clocked;
  for (std::size_t i = 0; i < names.size(); ++i) {
    auto written = write_one(clocked, names[i], values[i]);
    if (!written) return tl::unexpected(std::move(written.error()));
  }
  if (clocked.chip.write(Register::position, params.distance_microsteps)) return clocked;
  const auto& position = Mc1451a::registers()[static_cast<std::size_t>(Register::position)];
  return tl::unexpected(param_error<&Simulate::distance_microsteps>(
      "out_of_range", fmt::format("'distance_microsteps' of an {} is {}..{}", mc1451a_name,
                                  position.minimum, position.maximum)));
}

/// Its time, its top speed, and the longest part in which the speed changes: at most seven phases.
void follow(Clocked clocked, Simulated& result) {
  constexpr int most_phases = 16;
  auto& chip = clocked.chip;
  for (int phase = 0; phase < most_phases && !chip.arrived() && !chip.settled(); ++phase) {
    const auto from = chip.tick();
    const auto to = chip.next_change();
    if (to == tmcl::ramp::forever) break;
    const double speed = std::abs(clocked.speed());
    chip.advance_to(to);
    const double after = std::abs(clocked.speed());
    result.top_speed_pps = std::max({result.top_speed_pps, speed, after});
    if (after != speed)
      result.longest_phase_s = std::max(result.longest_phase_s, clocked.seconds(to - from));
  }
  if (chip.arrived()) result.move_s = clocked.seconds(chip.tick());
}

Curve curve_of(Clocked clocked, double until_s, int points) {
  Curve curve;
  for (int point = 0; point < points; ++point) {
    const double time = until_s * point / (points - 1);
    clocked.chip.advance_to(clocked.ticks(time));
    curve.times_s.push_back(time);
    curve.positions_microsteps.push_back(static_cast<std::int32_t>(clocked.chip.motion().position));
    curve.velocities_pps.push_back(clocked.speed());
    curve.accelerations_pps2.push_back(clocked.acceleration());
  }
  return curve;
}

}  // namespace

Result<Simulated> mc1451a_move(const Simulate& params) {
  if (params.resonance_hz) {
    return tl::unexpected(param_error<&Simulate::resonance_hz>(
        "bad_argument", fmt::format("no load is followed behind an {}", mc1451a_name)));
  }
  const auto clocked = set_up(params);
  if (!clocked) return tl::unexpected(clocked.error());
  Simulated result{std::string(mc1451a_name)};
  follow(*clocked, result);
  result.warnings = warnings_of(clocked->chip);
  const auto until = params.until_s ? params.until_s : result.move_s;
  if (params.points && until) result.curve = curve_of(*clocked, *until, *params.points);
  return result;
}

}  // namespace tmcld

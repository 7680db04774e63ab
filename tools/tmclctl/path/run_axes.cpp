#include "path/run_axes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "foresight.hpp"
#include "tmcl/conversion.hpp"

namespace tmclctl::path {
namespace {

namespace ap = tmcl::axis_parameter;
using tmcl::plan::StreamMode;

constexpr std::uint8_t stop_velocity = 20;

// G-code counts in mm, and turns in degrees; the axes of a table are in their own units.
Attempt<void> check_unit(const Source& source, const std::string& of_file, const AxisUnits& units) {
  if (!source.gcode || !units.scale || units.scale->unit.empty()) return {};
  const std::string needed = of_file < "X" ? "deg" : "mm";
  if (units.scale->unit == needed) return {};
  return tl::unexpected(
      impossible("wrong_unit", fmt::format("axis {} of G-code is in {}, and {} in {}", of_file,
                                           needed, units.axis, units.scale->unit)));
}

Attempt<std::int32_t> value_of(const std::string& axis, std::uint8_t parameter, Target& target) {
  return target.get(axis, std::to_string(parameter)).map([](const ParameterValue& value) {
    return value.value;
  });
}

tmcl::ValueRange range_of(const AxisUnits& units, std::uint8_t parameter) {
  const auto* row = find_parameter(units.parameters(), parameter);
  if (row == nullptr) return {0, 0};
  return tmcl::range_of(*row, tmcl::initial_units(*units.model), *units.module);
}

Attempt<RunAxis> read_axis(const Source& source, const AxisChoice& choice, const RunWish& wish,
                           Target& target) {
  const auto units = target.units(choice.axis);
  if (!units) return tl::unexpected(units.error());
  if (units->model == nullptr || !units->module) {
    return tl::unexpected(impossible(
        "unknown_units", fmt::format("what the module of {} counts in is not known", choice.axis)));
  }
  if (const auto fits = check_unit(source, choice.of_file, *units); !fits)
    return tl::unexpected(fits.error());
  const auto scale = microsteps_of_unit(*units, wish.per_turn);
  if (!scale) return tl::unexpected(scale.error());
  const auto state = target.state(choice.axis);
  if (!state) return tl::unexpected(state.error());
  if (state->moving)
    return tl::unexpected(impossible("moving", fmt::format("{} is moving", choice.axis)));
  const auto velocity = value_of(choice.axis, ap::max_velocity, target);
  if (!velocity) return tl::unexpected(velocity.error());
  const auto acceleration = value_of(choice.axis, ap::max_acceleration, target);
  if (!acceleration) return tl::unexpected(acceleration.error());

  RunAxis axis{choice.of_file, choice.axis, {}, units->limits, {}, 0, 0};
  axis.stream = {*scale,
                 *units->module,
                 range_of(*units, ap::target_velocity).greatest,
                 range_of(*units, ap::max_acceleration).greatest,
                 range_of(*units, stop_velocity).greatest,
                 {}};
  axis.range = range_of(*units, ap::target_position);
  axis.velocity = *velocity * units->module->velocity.value / std::abs(*scale);
  axis.acceleration = *acceleration * units->module->acceleration.value / std::abs(*scale);
  if (axis.velocity <= 0 || axis.acceleration <= 0) {
    return tl::unexpected(impossible(
        "no_limits", fmt::format("{} has max_velocity {} and max_acceleration {}: it cannot move",
                                 choice.axis, *velocity, *acceleration)));
  }
  if (wish.mode == StreamMode::position) {
    auto twin = twin_of(choice.axis, target);
    if (!twin) return tl::unexpected(twin.error());
    axis.stream.twin = std::move(*twin);
  } else if (axis.soft_limits) {
    return tl::unexpected(impossible(
        "soft_limits",
        fmt::format("{} has soft limits: tmcld does not let it turn by velocity", choice.axis),
        "--mode position moves between targets"));
  }
  return axis;
}

Attempt<AxisChoice> choice_for(const std::string& of_file, const std::vector<AxisChoice>& choices) {
  const auto found = std::ranges::find(choices, of_file, &AxisChoice::of_file);
  if (found != choices.end()) return *found;
  return tl::unexpected(
      usage_failure("missing_axis", fmt::format("the file moves {}: which axis is that?", of_file),
                    fmt::format("--axis {}=NAME", of_file)));
}

}  // namespace

Failure impossible(std::string name, std::string message, std::string hint) {
  auto failure = usage_failure(std::move(name), std::move(message), std::move(hint));
  failure.exit = ExitCode::refused;
  failure.outcome = tmcl::Outcome::not_sent;
  return failure;
}

Attempt<double> microsteps_of_unit(const AxisUnits& units, std::optional<double> per_turn) {
  if (!units.scale) {
    return tl::unexpected(
        impossible("unknown_units",
                   fmt::format("how many microsteps a turn of {} has is not known", units.axis)));
  }
  const double turn = units.scale->steps.per_revolution();
  if (!units.scale->unit.empty()) {
    const double direction = units.scale->reverse ? -1 : 1;
    return direction * turn / units.scale->units_per_motor_revolution();
  }
  if (per_turn) return turn / *per_turn;
  return tl::unexpected(usage_failure(
      "unknown_unit", fmt::format("{} has no unit", units.axis),
      "--per-turn says how many units of the file a turn of the motor is; tmcld.toml can, too"));
}

tmcl::Microsteps microsteps(const RunAxis& axis, double position) {
  return {static_cast<std::int32_t>(std::lround(position * axis.stream.microsteps_per_unit))};
}

Attempt<std::vector<RunAxis>> read_axes(const Source& source,
                                        const std::vector<AxisChoice>& choices, const RunWish& wish,
                                        Target& target) {
  for (const auto& choice : choices) {
    const auto& known = source.path.axes;
    if (std::ranges::find(known, choice.of_file) != known.end()) continue;
    return tl::unexpected(
        usage_failure("unknown_axis", fmt::format("{} has no axis {}", source.file, choice.of_file),
                      fmt::format("It has {}", fmt::join(known, ", "))));
  }
  std::vector<RunAxis> axes;
  for (const auto& of_file : source.path.axes) {
    const auto choice = choice_for(of_file, choices);
    if (!choice) return tl::unexpected(choice.error());
    if (std::ranges::find(axes, choice->axis, &RunAxis::name) != axes.end()) {
      return tl::unexpected(usage_failure("usage", fmt::format("{} is named twice", choice->axis)));
    }
    auto axis = read_axis(source, *choice, wish, target);
    if (!axis) return tl::unexpected(axis.error());
    axes.push_back(std::move(*axis));
  }
  return axes;
}

tmcl::plan::PathLimits limits_of(const std::vector<RunAxis>& axes, const RunWish& wish) {
  tmcl::plan::PathLimits limits;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    limits.axis[i] = {
        std::min(axes[i].velocity, wish.velocity.value_or(axes[i].velocity)),
        std::min(axes[i].acceleration, wish.acceleration.value_or(axes[i].acceleration))};
  }
  return limits;
}

Attempt<void> check_reach(const tmcl::plan::Course& course, const std::vector<RunAxis>& axes) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto& axis = axes[i];
    for (const double position : {course.least()[i], course.greatest()[i]}) {
      const auto& soft = axis.soft_limits;
      if (soft && (position < soft->least.value || position > soft->greatest.value)) {
        return tl::unexpected(impossible(
            "soft_limit",
            fmt::format(
                "the path goes to {} {:.6g}, and the soft limits of {} are {:.6g} to {:.6g}",
                axis.of_file, position, axis.name, soft->least.value, soft->greatest.value)));
      }
      const double there = position * axis.stream.microsteps_per_unit;
      if (there >= axis.range.least && there <= axis.range.greatest) continue;
      return tl::unexpected(impossible(
          "out_of_range",
          fmt::format("the path goes to {} {:.6g}: {:.0f} microsteps, and {} can go to {} to {}",
                      axis.of_file, position, there, axis.name, axis.range.least,
                      axis.range.greatest)));
    }
  }
  return {};
}

}  // namespace tmclctl::path

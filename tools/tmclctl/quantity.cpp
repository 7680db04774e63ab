#include "quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "options/form.hpp"
#include "tmcl/nearest.hpp"
#include "tmcl/parameter_units.hpp"

namespace tmclctl {
namespace {

using tmcl::Dimension;

// The units that every axis has.
constexpr std::string_view microsteps_name = "microsteps";
constexpr std::string_view revolution_name = "rev";

struct KnownUnit {
  std::string_view name;
  std::string_view base;
  double of_base;  // how many of it make one of the base
  int per_seconds;
};
constexpr auto known_units = std::to_array<KnownUnit>({
    {"microstep", microsteps_name, 1, 0},
    {microsteps_name, microsteps_name, 1, 0},
    {"pps", microsteps_name, 1, 1},
    {revolution_name, revolution_name, 1, 0},
    {"rps", revolution_name, 1, 1},
    {"rpm", revolution_name, 60, 1},
});

struct Suffix {
  std::string_view text;
  int per_seconds;
};
// The longest first.
constexpr auto suffixes =
    std::to_array<Suffix>({{"/s^2", 2}, {"/s/s", 2}, {"/s2", 2}, {"/s", 1}, {"", 0}});

struct UnitName {
  std::string_view base;
  int per_seconds = 0;
};

UnitName split(std::string_view unit) {
  const auto* suffix =
      std::ranges::find_if(suffixes, [&](const Suffix& one) { return unit.ends_with(one.text); });
  unit.remove_suffix(suffix->text.size());
  return {unit, suffix->per_seconds};
}

bool may_be_unit(std::string_view unit) {
  const auto base = split(unit).base;
  return std::ranges::count(tmcl::reserved_unit_names(), base) != 0 ||
         tmcl::fault_of_unit_name(base).empty();
}

/// What one of a unit is.
struct Unit {
  tmcl::UserScale scale;
  int per_seconds = 0;
};

std::string units_of(const AxisUnits& units) {
  std::string text = "microsteps, rev, pps, rps, rpm";
  if (units.scale && !units.scale->unit.empty())
    text += fmt::format(", {0} and {0}/s", units.scale->unit);
  return text;
}

Failure unknown_unit(const Quantity& quantity, std::string_view base, const AxisUnits& units) {
  std::vector<std::string_view> names(tmcl::reserved_unit_names().begin(),
                                      tmcl::reserved_unit_names().end());
  const bool has_own = units.scale && !units.scale->unit.empty();
  if (has_own) names.push_back(units.scale->unit);
  auto hint = "It has: " + units_of(units) + "." + tmcl::did_you_mean(base, names);
  if (!has_own)
    hint += " Units of its own come from tmcld's configuration: unit and units_per_revolution";
  return usage_failure(
      "unknown_unit",
      fmt::format("'{}': axis {} has no unit '{}'", to_string(quantity), units.axis, base), hint);
}

Failure unknown_turn(const Quantity& quantity, const AxisUnits& units) {
  return usage_failure("unknown_unit",
                       fmt::format("'{}': how many microsteps a turn of axis {} has is not known",
                                   to_string(quantity), units.axis),
                       "Give a number of microsteps; tmcld's configuration can have the key "
                       "microsteps");
}

Attempt<Unit> unit_of(const Quantity& quantity, const AxisUnits& units) {
  const auto name = split(quantity.unit);
  const auto* known = std::ranges::find(known_units, name.base, &KnownUnit::name);
  if (known != known_units.end() && known->base == microsteps_name)
    return Unit{tmcl::microsteps_scale(), known->per_seconds + name.per_seconds};
  const bool own = units.scale && !name.base.empty() && units.scale->unit == name.base;
  if (known == known_units.end() && !own)
    return tl::unexpected(unknown_unit(quantity, name.base, units));
  if (!units.scale) return tl::unexpected(unknown_turn(quantity, units));
  if (own) return Unit{*units.scale, name.per_seconds};
  auto turns = tmcl::revolutions(*units.scale);
  turns.units_per_revolution = known->of_base;
  return Unit{turns, known->per_seconds + name.per_seconds};
}

struct Expected {
  int per_seconds;
  std::string_view what;
  std::string_view examples;
};
constexpr Expected a_position{0, "position", "10240, 1.5rev"};
constexpr Expected a_velocity{1, "velocity", "500, 20000pps, 2rps, 120rpm"};
constexpr Expected an_acceleration{2, "acceleration", "500, 100000pps/s, 10rps/s"};

Attempt<Unit> unit_for(const Expected& expected, const Quantity& quantity, const AxisUnits& units) {
  auto unit = unit_of(quantity, units);
  if (!unit || unit->per_seconds == expected.per_seconds) return unit;
  return tl::unexpected(
      usage_failure("wrong_unit", fmt::format("'{}' is no {}", to_string(quantity), expected.what),
                    fmt::format("That is such as {}, or {}{}", expected.examples, unit->scale.unit,
                                expected.per_seconds == 0   ? ""
                                : expected.per_seconds == 1 ? "/s"
                                                            : "/s^2")));
}

Failure unknown_counting(const Quantity& quantity, const AxisUnits& units) {
  return usage_failure("unknown_unit",
                       fmt::format("'{}': what the module of axis {} counts in is not known",
                                   to_string(quantity), units.axis),
                       "Give a bare number, in the module's own unit");
}

Failure measures_nothing(const Quantity& quantity, const tmcl::ParameterInfo& row) {
  return usage_failure("wrong_unit",
                       fmt::format("'{}': {} is neither a position nor a velocity nor an "
                                   "acceleration",
                                   to_string(quantity), row.name),
                       "Give a bare number");
}

bool is_in_counts(const tmcl::ParameterInfo& row, const AxisUnits& units) {
  return units.encoder_counts_per_unit && is_encoder_position(row);
}

// How many counts a turn has is not known, only how many a unit.
Attempt<Unit> unit_in_counts(const Quantity& quantity, const AxisUnits& units,
                             const tmcl::ParameterInfo& row) {
  if (!units.scale) return tl::unexpected(unknown_turn(quantity, units));
  const auto& unit = units.scale->unit;
  if (quantity.unit == unit) return Unit{*units.scale, 0};
  return tl::unexpected(usage_failure(
      "wrong_unit",
      fmt::format("'{}': {} is in counts of the encoder", to_string(quantity), row.name),
      fmt::format("Give it in {}, or a bare number of counts", unit)));
}

const Expected& expected_for(Dimension dimension) {
  if (dimension == Dimension::position) return a_position;
  return dimension == Dimension::velocity ? a_velocity : an_acceleration;
}

tmcl::AxisScale scale_in(const tmcl::UserScale& scale, const AxisUnits& units) {
  return {units.model, scale, units.module, units.encoder_counts_per_unit};
}

}  // namespace

std::string to_string(const Quantity& quantity) {
  return fmt::format("{}{}", quantity.number, quantity.unit);
}

tl::expected<Quantity, std::string> parse_quantity(std::string_view text) {
  auto digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const std::string_view unit(end, static_cast<std::size_t>(digits.data() + digits.size() - end));
  const bool numeric = error == std::errc{} && std::isfinite(value);
  if (!numeric || unit.empty() || !may_be_unit(unit)) {
    return parse_number<std::int32_t>(text).map([](std::int32_t whole) {
      return Quantity{static_cast<double>(whole), {}};
    });
  }
  return Quantity{value, std::string(unit)};
}

Dimension dimension_of(const Quantity& quantity) {
  if (quantity.unit.empty()) return Dimension::other;
  const auto name = split(quantity.unit);
  const auto* known = std::ranges::find(known_units, name.base, &KnownUnit::name);
  const auto per_seconds = name.per_seconds + (known == known_units.end() ? 0 : known->per_seconds);
  if (per_seconds == 0) return Dimension::position;
  return per_seconds == 1 ? Dimension::velocity : Dimension::acceleration;
}

tmcl::UserScale AxisUnits::limits_scale() const {
  return scale && !scale->unit.empty() ? *scale : tmcl::microsteps_scale();
}

std::span<const tmcl::ParameterInfo> AxisUnits::parameters() const {
  return model == nullptr ? std::span<const tmcl::ParameterInfo>{} : tmcl::axis_parameters(*model);
}

Attempt<tmcl::Microsteps> to_microsteps(const Quantity& quantity, const AxisUnits& units,
                                        tmcl::ValueRange range) {
  if (quantity.unit.empty()) return tmcl::Microsteps{static_cast<std::int32_t>(quantity.number)};
  const auto unit = unit_for(a_position, quantity, units);
  if (!unit) return tl::unexpected(unit.error());
  return tmcl::to_microsteps(tmcl::UserPosition{quantity.number}, unit->scale, range)
      .map_error([&](const tmcl::OutOfReach& error) {
        return usage_failure("out_of_range", describe(error));
      });
}

Attempt<tmcl::PulsesPerSecond> to_pps(const Quantity& quantity, const AxisUnits& units) {
  if (quantity.unit.empty()) {
    if (!units.module) return tl::unexpected(unknown_counting(quantity, units));
    const tmcl::InternalVelocity bare{static_cast<std::int32_t>(quantity.number)};
    return tmcl::to_pps(bare, *units.module);
  }
  return unit_for(a_velocity, quantity, units).map([&](const Unit& unit) {
    return tmcl::to_pps(tmcl::UserVelocity{quantity.number}, unit.scale);
  });
}

Attempt<tmcl::PulsesPerSecond2> to_pps2(const Quantity& quantity, const AxisUnits& units) {
  if (quantity.unit.empty()) {
    if (!units.module) return tl::unexpected(unknown_counting(quantity, units));
    const tmcl::InternalAcceleration bare{static_cast<std::int32_t>(quantity.number)};
    return tmcl::to_pps2(bare, *units.module);
  }
  return unit_for(an_acceleration, quantity, units).map([&](const Unit& unit) {
    return tmcl::to_pps2(tmcl::UserAcceleration{quantity.number}, unit.scale);
  });
}

Failure out_of_reach(const Quantity& quantity, const AxisUnits& units, tmcl::OutOfReach error) {
  const auto unit = unit_of(quantity, units);
  if (!quantity.unit.empty() && unit) {
    error = unit->per_seconds == 1 ? tmcl::in_velocity_units(error, unit->scale)
                                   : tmcl::in_acceleration_units(error, unit->scale);
    error.wished = quantity.number;
    error.unit = quantity.unit;
  }
  return usage_failure("out_of_range", describe(error));
}

Attempt<std::int32_t> to_parameter(const Quantity& quantity, const AxisUnits& units,
                                   const tmcl::ParameterInfo& row) {
  if (quantity.unit.empty()) return static_cast<std::int32_t>(quantity.number);
  const auto dimension = dimension_of(row);
  if (dimension == Dimension::other) return tl::unexpected(measures_nothing(quantity, row));
  const auto unit = is_in_counts(row, units) ? unit_in_counts(quantity, units, row)
                                             : unit_for(expected_for(dimension), quantity, units);
  if (!unit) return tl::unexpected(unit.error());
  if (dimension != Dimension::position && !units.module)
    return tl::unexpected(unknown_counting(quantity, units));
  return Attempt<std::int32_t>(
      tmcl::to_parameter(quantity.number, row, scale_in(unit->scale, units))
          .map_error([&](tmcl::OutOfReach error) {
            error.wished = quantity.number;
            error.unit = quantity.unit;
            return usage_failure("out_of_range", describe(error));
          }));
}

Attempt<Quantity> from_parameter(std::int32_t value, const AxisUnits& units,
                                 const tmcl::ParameterInfo& row) {
  const Quantity bare{static_cast<double>(value), {}};
  const auto dimension = dimension_of(row);
  if (dimension == Dimension::other) return tl::unexpected(measures_nothing(bare, row));
  if (!units.scale) return tl::unexpected(unknown_turn(bare, units));
  const auto scale = units.scale->unit.empty() ? tmcl::revolutions(*units.scale) : *units.scale;
  const auto in_unit = to_user(value, row, scale_in(scale, units));
  if (!in_unit) return tl::unexpected(unknown_counting(bare, units));
  return Quantity{in_unit->value, in_unit->unit};
}

}  // namespace tmclctl

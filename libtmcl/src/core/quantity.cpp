#include "tmcl/quantity.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "tmcl/correction.hpp"
#include "tmcl/hex.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl {
namespace {

enum class Base : std::uint8_t { microstep, turn, length, angle };
struct KnownUnit {
  std::string_view name;
  Base base;
  double size;  // against the other units of this base
  int per_seconds;
};
constexpr auto known_units = std::to_array<KnownUnit>({
    {"microsteps", Base::microstep, 1, 0},
    {"microstep", Base::microstep, 1, 0},
    {"pps", Base::microstep, 1, 1},
    {"rev", Base::turn, 60, 0},
    {"rps", Base::turn, 60, 1},
    {"rpm", Base::turn, 1, 1},
    {"um", Base::length, 1, 0},
    {"mm", Base::length, 1'000, 0},
    {"cm", Base::length, 10'000, 0},
    {"m", Base::length, 1'000'000, 0},
    {"in", Base::length, 25'400, 0},
    {"deg", Base::angle, std::numbers::pi, 0},
    {"rad", Base::angle, 180, 0},
    // As keyboards have them: the micro sign and the Greek letter, and the degree sign.
    {"\u00B5m", Base::length, 1, 0},
    {"\u03BCm", Base::length, 1, 0},
    {"\u00B0", Base::angle, std::numbers::pi, 0},
});
constexpr double size_of_turn = 60;

const KnownUnit* find_unit(std::string_view name) {
  const auto* known = std::ranges::find(known_units, name, &KnownUnit::name);
  return known == known_units.end() ? nullptr : known;
}

struct Suffix {
  std::string_view text;
  int per_seconds;
};
// The longest first.
constexpr auto suffixes = std::to_array<Suffix>({{"/s/s/s", 3},
                                                 {"/s\u00B3", 3},
                                                 {"/s\u00B2", 2},
                                                 {"/s^3", 3},
                                                 {"/s3", 3},
                                                 {"/s^2", 2},
                                                 {"/s/s", 2},
                                                 {"/s2", 2},
                                                 {"/s", 1},
                                                 {"", 0}});

/// What stands behind a number: "mm" and 1 for "mm/s".
struct UnitName {
  std::string_view base;
  const KnownUnit* known;  // null: of a configuration, or none at all
  int per_seconds;
};

UnitName split(std::string_view unit) {
  const auto* suffix =
      std::ranges::find_if(suffixes, [&](const Suffix& one) { return unit.ends_with(one.text); });
  unit.remove_suffix(suffix->text.size());
  const auto* known = find_unit(unit);
  return {unit, known, suffix->per_seconds + (known == nullptr ? 0 : known->per_seconds)};
}

tl::unexpected<Error> failed(Errc code, std::string message, std::string hint = {}) {
  return tl::unexpected(not_sent(code, std::move(message), std::move(hint)));
}

// ---- text ----

constexpr std::string_view example = "It is a number and a unit, such as 12.5mm or 300rpm";

// So that each can be shown whole where texts are cut.
constexpr std::size_t most_quantity_bytes = 64;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// With the minus sign and the blanks of a keyboard instead of those of typesetters.
std::string typed(std::string_view text) {
  struct Sign {
    std::string_view typeset;
    std::string_view plain;
  };
  constexpr auto signs =
      std::to_array<Sign>({{"\u2212", "-"}, {"\u00A0", " "}, {"\u2009", " "}, {"\u202F", " "}});
  std::string plain(text);
  for (const auto& sign : signs) {
    for (auto at = plain.find(sign.typeset); at != std::string::npos; at = plain.find(sign.typeset))
      plain.replace(at, sign.typeset.size(), sign.plain);
  }
  return plain;
}

/// `rest` is what stands behind the number.
tl::unexpected<Error> bad_rest(std::string_view text, std::string_view rest) {
  if (rest.size() > 1 && rest[0] == ',' && is_digit(rest[1])) {
    auto mended = std::string(text);
    mended[text.size() - rest.size()] = '.';
    return failed(Errc::decimal_comma, quoted(text) + " has a comma in its number",
                  "The decimal sign is a point: " + mended);
  }
  return failed(Errc::two_units, quoted(text) + " is more than one number and one unit",
                std::string(example));
}

// ---- units of an axis ----

const KnownUnit* own_unit(const AxisUnits& units) {
  return units.has_unit() ? find_unit(units.scale->unit) : nullptr;
}

bool converts_into_own(const UnitName& name, const AxisUnits& units) {
  if (!units.has_unit()) return false;
  const auto* own = own_unit(units);
  return name.base == units.scale->unit ||
         (own != nullptr && name.known != nullptr && name.known->base == own->base);
}

/// How many of it make one of the unit of the axis.
double part_of_own(const UnitName& name, const AxisUnits& units) {
  return name.base == units.scale->unit ? 1 : own_unit(units)->size / name.known->size;
}

Error unknown_unit(const Quantity& quantity, const UnitName& name, const AxisUnits& units) {
  std::vector<std::string_view> names;
  for (const auto& unit : known_units) {
    const bool of_every_axis = unit.base == Base::microstep || unit.base == Base::turn;
    const bool plain = static_cast<unsigned char>(unit.name.front()) < 0x80;
    if (plain && (of_every_axis || converts_into_own({unit.name, &unit, 0}, units)))
      names.push_back(unit.name);
  }
  if (units.has_unit() && own_unit(units) == nullptr) names.push_back(units.scale->unit);
  std::string hint = "It has: ";
  for (const auto unit : names) hint += std::string(unit) + ", ";
  hint += "and /s behind them." + did_you_mean(name.base, names);
  if (!units.has_unit())
    hint += " Units of its own come from the configuration: unit and units_per_revolution";
  return not_sent(
      Errc::unknown_unit,
      quoted(to_string(quantity)) + ": axis " + units.axis + " has no unit " + quoted(name.base),
      std::move(hint));
}

tl::unexpected<Error> unknown_turn(const Quantity& quantity, const AxisUnits& units) {
  return failed(Errc::unknown_unit,
                quoted(to_string(quantity)) + ": how many microsteps a turn of axis " + units.axis +
                    " has is not known",
                "Give a number of microsteps; the configuration can have the key microsteps");
}

tl::unexpected<Error> unknown_counting(const Quantity& quantity, const AxisUnits& units) {
  return failed(Errc::unknown_unit,
                quoted(to_string(quantity)) + ": what the module of axis " + units.axis +
                    " counts in is not known",
                "Give a bare number, in the module's own unit");
}

tl::unexpected<Error> measures_nothing(const Quantity& quantity, const ParameterInfo& row) {
  return failed(Errc::wrong_unit,
                quoted(to_string(quantity)) + ": " + std::string(row.name) +
                    " is neither a position nor a velocity nor an acceleration",
                "Give a bare number");
}

/// Measured in the unit of the quantity.
Result<UserScale> scale_of(const Quantity& quantity, const AxisUnits& units) {
  const auto name = split(quantity.unit);
  if (name.known != nullptr && name.known->base == Base::microstep) return microsteps_scale();
  const bool in_turns = name.known != nullptr && name.known->base == Base::turn;
  if (!in_turns && !converts_into_own(name, units))
    return tl::unexpected(unknown_unit(quantity, name, units));
  if (!units.scale) return unknown_turn(quantity, units);
  auto scale = in_turns ? revolutions(*units.scale) : *units.scale;
  const double count = in_turns ? size_of_turn / name.known->size : part_of_own(name, units);
  scale.units_per_revolution *= count;
  if (scale.correction && count != 1)
    scale.correction = std::make_shared<const Correction>(scale.correction->in_unit(count));
  scale.unit = name.base;
  return scale;
}

struct Expected {
  std::string_view what;
  std::string_view examples;
};
constexpr Expected expected_of(Dimension dimension) {
  if (dimension == Dimension::position) return {"position", "10240microsteps, 1.5rev"};
  if (dimension == Dimension::velocity) return {"velocity", "20000pps, 2rps, 120rpm"};
  return {"acceleration", "100000pps/s, 10rps/s"};
}

/// The same for one that must measure this.
Result<UserScale> scale_for(Dimension dimension, const Quantity& quantity, const AxisUnits& units) {
  auto scale = scale_of(quantity, units);
  const int per_seconds = static_cast<int>(dimension) - static_cast<int>(Dimension::position);
  if (!scale || split(quantity.unit).per_seconds == per_seconds) return scale;
  const auto [what, examples] = expected_of(dimension);
  auto hint = "That is such as " + std::string(examples);
  if (units.has_unit()) hint += ", or in " + unit_of(dimension, units.scale->unit);
  return failed(Errc::wrong_unit, quoted(to_string(quantity)) + " is no " + std::string(what),
                std::move(hint));
}

// ---- values of a module ----

Result<std::int32_t> bare_value(const Quantity& quantity, const AxisUnits& units,
                                Dimension dimension) {
  if (units.has_unit() && quantity.number != 0 && dimension != Dimension::other)
    return tl::unexpected(bare_number(quantity, dimension, units.scale->unit));
  const auto text = quoted(to_string(quantity));
  if (std::trunc(quantity.number) != quantity.number)
    return failed(Errc::bad_quantity, text + " is no whole number, which the module counts in");
  if (!(quantity.number >= INT32_MIN && quantity.number <= INT32_MAX))
    return failed(Errc::out_of_range, text + " is not within -2147483648 to 2147483647");
  return static_cast<std::int32_t>(quantity.number);
}

template <class T>
std::int32_t number_of(T value) {
  return value.value;
}

/// `units.module` is known where it is no position.
Reached<std::int32_t> in_module(double number, Dimension dimension, const UserScale& scale,
                                const AxisUnits& units, ValueRange range) {
  if (dimension == Dimension::position)
    return to_microsteps(UserPosition{number}, scale, range).map(number_of<Microsteps>);
  if (dimension == Dimension::velocity) {
    return to_internal(to_pps(UserVelocity{number}, scale), *units.module, range)
        .map(number_of<InternalVelocity>)
        .map_error([&](const OutOfReach& error) { return in_velocity_units(error, scale); });
  }
  return to_internal(to_pps2(UserAcceleration{number}, scale), *units.module, range)
      .map(number_of<InternalAcceleration>)
      .map_error([&](const OutOfReach& error) { return in_acceleration_units(error, scale); });
}

/// With the microsteps that would do, if there are.
Error out_of_range(const Quantity& quantity, const AxisUnits& units, OutOfReach error) {
  error.wished = quantity.number;
  error.unit = quantity.unit;
  auto told = not_sent(Errc::out_of_range, describe(error));
  const auto excess = std::abs(error.wished / error.nearest);
  if (units.scale && !is_in_microsteps(quantity) && excess > 1)
    told.hint = hint_of_resolution(units.scale->steps.resolution,
                                   [&](double share) { return excess * share <= 1; });
  return told;
}

bool is_in_counts(const ParameterInfo& row, const AxisUnits& units) {
  return units.encoder_counts_per_unit && is_encoder_position(row);
}

/// For what an encoder reads: only lengths and angles can be told in its counts.
Result<std::int32_t> to_counts(const Quantity& quantity, const AxisUnits& units,
                               const ParameterInfo& row) {
  if (!units.scale) return unknown_turn(quantity, units);
  const auto own = in_own_unit(quantity, units);
  if (!own || dimension_of(quantity) != Dimension::position) {
    return failed(
        Errc::wrong_unit,
        quoted(to_string(quantity)) + ": " + std::string(row.name) + " is in counts of the encoder",
        "Give it in " + units.scale->unit + ", or a bare number of counts");
  }
  const auto scale = encoder_scale(*units.encoder_counts_per_unit, *units.scale);
  return in_module(*own, Dimension::position, scale, units, {row.minimum, row.maximum})
      .map_error(
          [](const OutOfReach& error) { return not_sent(Errc::out_of_range, describe(error)); });
}

/// What a module counts velocities or accelerations in.
Result<std::int32_t> bare_rate(const Quantity& quantity, const AxisUnits& units,
                               Dimension dimension) {
  if (!units.module) return unknown_counting(quantity, units);
  return bare_value(quantity, units, dimension);
}

}  // namespace

std::string to_string(const Quantity& quantity) {
  return plain_number(quantity.number) + quantity.unit;
}

Dimension dimension_of(const Quantity& quantity) {
  if (quantity.unit.empty()) return Dimension::other;
  const auto per_seconds = split(quantity.unit).per_seconds;
  if (per_seconds == 0) return Dimension::position;
  return per_seconds == 1 ? Dimension::velocity : Dimension::acceleration;
}

bool is_in_microsteps(const Quantity& quantity) {
  const auto* known = split(quantity.unit).known;
  return quantity.unit.empty() || (known != nullptr && known->base == Base::microstep);
}

std::string unit_of(Dimension dimension, const std::string& unit) {
  if (dimension == Dimension::other) return {};
  if (dimension == Dimension::position) return unit;
  return unit + (dimension == Dimension::velocity ? "/s" : "/s^2");
}

std::string unit_of(const ParameterInfo& row, const std::string& unit) {
  return unit_of(dimension_of(row), unit);
}

Result<Quantity> parse_quantity(std::string_view text) {
  if (text.size() > most_quantity_bytes) {
    return failed(Errc::bad_quantity,
                  "a quantity of " + std::to_string(text.size()) + " letters is too long",
                  "It has at most " + std::to_string(most_quantity_bytes));
  }
  if (const auto hexadecimal = parse_hexadecimal(text))
    return Quantity{static_cast<double>(*hexadecimal), {}};
  const auto plain = typed(text);
  std::string_view digits = plain;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const auto rest = digits.substr(static_cast<std::size_t>(end - digits.data()));
  const auto unit = rest.substr(std::min(rest.find_first_not_of(' '), rest.size()));
  const auto base = split(unit).base;
  if (error == std::errc::invalid_argument || (base.empty() && !unit.empty()))
    return failed(Errc::bad_quantity, quoted(text) + " is no number with a unit",
                  std::string(example));
  if (error != std::errc{} || !std::isfinite(number))
    return failed(Errc::not_finite, quoted(text) + " is no finite number", std::string(example));
  const auto is_of_no_unit = [](char c) { return is_digit(c) || c == ' ' || c == ',' || c == '.'; };
  if (std::ranges::any_of(base, is_of_no_unit)) return bad_rest(text, rest);
  return Quantity{number, std::string(unit)};
}

std::span<const ParameterInfo> AxisUnits::parameters() const {
  return model == nullptr ? std::span<const ParameterInfo>{} : axis_parameters(*model);
}

AxisUnits AxisUnits::undirected() const {
  auto units = *this;
  if (units.scale) units.scale = of_lengths(*units.scale);
  return units;
}

std::string hint_of_resolution(std::int32_t present,
                               const std::function<bool(double share)>& fits) {
  for (auto resolution = present - 1; resolution >= 0; --resolution) {
    if (!fits(std::exp2(resolution - present))) continue;
    const auto number = std::to_string(axis_parameter::microstep_resolution);
    return "With " + std::to_string(1 << resolution) + " microsteps a full step (parameter " +
           number + " set to " + std::to_string(resolution) + ") it can be had";
  }
  return {};
}

Error bare_number(const Quantity& quantity, Dimension dimension, const std::string& unit) {
  const auto number = to_string(Quantity{quantity.number, {}});
  const auto in_microsteps = dimension == Dimension::position   ? "microsteps"
                             : dimension == Dimension::velocity ? "pps"
                                                                : "pps/s";
  return not_sent(Errc::bare_number, quoted(number) + " has no unit, and the axis has one",
                  number + unit_of(dimension, unit) + " or " + number + in_microsteps);
}

std::optional<double> in_own_unit(const Quantity& quantity, const AxisUnits& units) {
  const auto name = split(quantity.unit);
  if (!converts_into_own(name, units)) return std::nullopt;
  if (name.base == units.scale->unit) return quantity.number;
  return quantity.number * name.known->size / own_unit(units)->size;
}

Result<Microsteps> to_microsteps(const Quantity& quantity, const AxisUnits& units,
                                 ValueRange range) {
  const auto as_microsteps = [](std::int32_t value) { return Microsteps{value}; };
  if (quantity.unit.empty())
    return bare_value(quantity, units, Dimension::position).map(as_microsteps);
  return scale_for(Dimension::position, quantity, units).and_then([&](const UserScale& scale) {
    return in_module(quantity.number, Dimension::position, scale, units, range)
        .map(as_microsteps)
        .map_error([&](const OutOfReach& error) { return out_of_range(quantity, units, error); });
  });
}

Result<PulsesPerSecond> to_pps(const Quantity& quantity, const AxisUnits& units) {
  if (quantity.unit.empty()) {
    return bare_rate(quantity, units, Dimension::velocity).map([&](std::int32_t value) {
      return to_pps(InternalVelocity{value}, *units.module);
    });
  }
  return scale_for(Dimension::velocity, quantity, units).map([&](const UserScale& scale) {
    return to_pps(UserVelocity{quantity.number}, scale);
  });
}

Result<PulsesPerSecond2> to_pps2(const Quantity& quantity, const AxisUnits& units) {
  if (quantity.unit.empty()) {
    return bare_rate(quantity, units, Dimension::acceleration).map([&](std::int32_t value) {
      return to_pps2(InternalAcceleration{value}, *units.module);
    });
  }
  return scale_for(Dimension::acceleration, quantity, units).map([&](const UserScale& scale) {
    return to_pps2(UserAcceleration{quantity.number}, scale);
  });
}

Result<std::int32_t> to_parameter(const Quantity& quantity, const AxisUnits& units,
                                  const ParameterInfo& row) {
  const auto dimension = dimension_of(row);
  if (quantity.unit.empty()) return bare_value(quantity, units, dimension);
  if (dimension == Dimension::other) return measures_nothing(quantity, row);
  const auto directed = row.minimum >= 0 ? units.undirected() : units;
  if (is_in_counts(row, units)) return to_counts(quantity, directed, row);
  const auto scale = scale_for(dimension, quantity, directed);
  if (!scale) return tl::unexpected(scale.error());
  ValueRange range{row.minimum, row.maximum};
  if (dimension != Dimension::position) {
    if (!units.module) return unknown_counting(quantity, units);
    range = range_of(row, initial_units(*units.model), *units.module);
  }
  return in_module(quantity.number, dimension, *scale, units, range)
      .map_error([&](const OutOfReach& error) { return out_of_range(quantity, units, error); });
}

Result<Quantity> from_parameter(std::int32_t value, const AxisUnits& units,
                                const ParameterInfo& row) {
  const Quantity bare{static_cast<double>(value), {}};
  const auto dimension = dimension_of(row);
  if (dimension == Dimension::other) return measures_nothing(bare, row);
  if (!units.scale) return unknown_turn(bare, units);
  if (dimension != Dimension::position && !units.module) return unknown_counting(bare, units);
  auto scale = units.has_unit() ? *units.scale : revolutions(*units.scale);
  if (row.minimum >= 0) scale = of_lengths(scale);
  if (is_in_counts(row, units)) scale = encoder_scale(*units.encoder_counts_per_unit, scale);
  const auto in_unit = [&](double number) {
    return Quantity{number, unit_of(dimension, scale.unit)};
  };
  if (dimension == Dimension::position) return in_unit(to_user(Microsteps{value}, scale).value);
  if (dimension == Dimension::velocity)
    return in_unit(to_user(to_pps(InternalVelocity{value}, *units.module), scale).value);
  return in_unit(to_user(to_pps2(InternalAcceleration{value}, *units.module), scale).value);
}

Error out_of_reach(const Quantity& quantity, const AxisUnits& units, OutOfReach error) {
  const auto scale = scale_of(quantity, units);
  if (quantity.unit.empty() || !scale) return not_sent(Errc::out_of_range, describe(error));
  return out_of_range(quantity, units,
                      dimension_of(quantity) == Dimension::velocity
                          ? in_velocity_units(error, *scale)
                          : in_acceleration_units(error, *scale));
}

}  // namespace tmcl

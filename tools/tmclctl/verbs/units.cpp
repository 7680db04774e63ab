// convert.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/json/array.hpp>

#include "axis/axis_names.hpp"
#include "output/print.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/axis_twin.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace ap = tmcl::axis_parameter;

/// The settings that a model has, over what it starts with.
Result<tmcl::ModuleUnits> units_of(const verb::Convert& verb, const tmcl::Model& model,
                                   std::span<const tmcl::ParameterInfo> table) {
  const auto numbers = tmcl::unit_parameters(model);
  std::vector<std::int32_t> values;
  for (const auto number : numbers) values.push_back(find_parameter(table, number)->initial);
  const auto refusal = [&](std::string_view option) {
    return tl::unexpected(
        usage_error("usage", fmt::format("convert: {} means nothing to a {}", option, model.name)));
  };
  const bool has_dividers = numbers.size() == 2;
  const bool has_mode = numbers.size() == 1;
  if (verb.pulse_div && !has_dividers) return refusal("--pulse-div");
  if (verb.ramp_div && !has_dividers) return refusal("--ramp-div");
  if (verb.unit_mode && !has_mode) return refusal("--unit-mode");
  if (verb.pulse_div) values[0] = *verb.pulse_div;
  if (verb.ramp_div) values[1] = *verb.ramp_div;
  if (verb.unit_mode) values[0] = *verb.unit_mode;
  return tmcl::module_units(model, values).value_or(tmcl::ModuleUnits{});
}

/// One quantity, in every unit there is for it.
struct Rendering {
  const char* key;   // in JSON
  const char* unit;  // for people
  double value;
};

json::object to_object(const std::vector<Rendering>& forms) {
  json::object object;
  for (const auto& form : forms) {
    const bool whole = std::abs(form.value) < 1e9 && form.value == std::round(form.value);
    object[form.key] =
        whole ? json::value(static_cast<std::int64_t>(form.value)) : json::value(form.value);
  }
  return object;
}

class Converter {
 public:
  Converter(Quantity quantity, AxisUnits units)
      : quantity_(std::move(quantity)), units_(std::move(units)) {}

  /// With the bow that comes nearest below, where the model has bows; it is refused if none does.
  Result<std::vector<Rendering>> jerk() const {
    const auto jerk = attempt(to_pps3(quantity_, units_));
    if (!jerk) return tl::unexpected(jerk.error());
    auto forms = forms_of(*jerk);
    if (units_.model->family != tmcl::Family::tmc457) return forms;
    if (const auto fault = tmcl::plan::jerk_out_of_reach(*units_.model, jerk->value)) {
      auto told = tmcl::plan::in_unit(*fault, {quantity_.number / jerk->value, quantity_.unit});
      told.wished = quantity_.number;
      return tl::unexpected(usage_error("out_of_range", describe(told)));
    }
    forms.push_back(
        {"bow", "as bow: the greatest that is no higher", static_cast<double>(bow_within(*jerk))});
    return forms;
  }
  std::vector<Rendering> bow(std::int32_t bow) const {
    if (bow == 0) {
      return {{"bow_value", "in the chip's unit: no bow, so ramps are trapezoids", 0},
              {"full_acceleration_s", "s to any acceleration", 0}};
    }
    const auto jerk = tmcl::to_pps3(bow);
    const auto* row = find_parameter(units_.parameters(), tmcl::number_of("acceleration"));
    const auto full = to_pps2(tmcl::InternalAcceleration{row->initial}, *units_.module);
    auto forms = forms_of(jerk);
    forms.insert(forms.begin(), {"bow_value", "in the chip's unit", std::ldexp(1.0, bow - 1)});
    forms.push_back({"full_acceleration_s", "s to the acceleration that the model starts with",
                     seconds_to(full, jerk)});
    return forms;
  }
  /// From rest to this velocity or back; a trapezoid without a bow.
  Result<std::vector<Rendering>> ramp(const Quantity& acceleration,
                                      std::optional<std::int32_t> bow) const {
    const auto v = parameter(ap::target_velocity);
    if (!v) return tl::unexpected(v.error());
    const auto a = Converter(acceleration, units_).parameter(ap::max_acceleration);
    if (!a) return tl::unexpected(a.error());
    const auto pps = to_pps(tmcl::InternalVelocity{std::abs(*v)}, *units_.module);
    const auto pps2 = to_pps2(tmcl::InternalAcceleration{*a}, *units_.module);
    if (pps2.value <= 0)
      return tl::unexpected(usage_error("out_of_range", "the acceleration must be above 0"));
    constexpr tmcl::PulsesPerSecond3 at_once{std::numeric_limits<double>::infinity()};
    const bool is_curved = bow.value_or(0) > 0;
    const auto length = ramp_length(pps, pps2, is_curved ? tmcl::to_pps3(*bow) : at_once);
    const auto revolutions = to_user(tmcl::PulsesPerSecond{length.microsteps}, turns()).value;
    return std::vector<Rendering>{{"duration_s", "s", length.seconds},
                                  {"microsteps", "microsteps", length.microsteps},
                                  {"revolutions", "rev", revolutions}};
  }
  Result<std::vector<Rendering>> position() const {
    return parameter(ap::target_position).map([&](std::int32_t value) {
      const tmcl::Microsteps at{value};
      return std::vector<Rendering>{{"microsteps", "microsteps", static_cast<double>(value)},
                                    {"full_steps", "full steps", to_user(at, full_steps()).value},
                                    {"revolutions", "rev", to_user(at, turns()).value}};
    });
  }
  Result<std::vector<Rendering>> velocity() const {
    return parameter(ap::target_velocity).map([&](std::int32_t value) {
      const auto pps = to_pps(tmcl::InternalVelocity{value}, *units_.module);
      const auto rps = to_user(pps, turns()).value;
      return std::vector<Rendering>{
          {"internal", "in the module's unit", static_cast<double>(value)},
          {"pps", "pps", pps.value},
          {"full_steps_per_second", "full steps/s", to_user(pps, full_steps()).value},
          {"rps", "rps", rps},
          {"rpm", "rpm", rps * 60}};
    });
  }
  Result<std::vector<Rendering>> acceleration() const {
    return parameter(ap::max_acceleration).map([&](std::int32_t value) {
      const auto pps2 = to_pps2(tmcl::InternalAcceleration{value}, *units_.module);
      return std::vector<Rendering>{
          {"internal", "in the module's unit", static_cast<double>(value)},
          {"pps2", "pps/s", pps2.value},
          {"full_steps_per_second2", "full steps/s^2", to_user(pps2, full_steps()).value},
          {"rps2", "rps/s", to_user(pps2, turns()).value}};
    });
  }

  /// What it may be that the quantity is, as the parameter that holds it.
  Result<std::int32_t> parameter(std::uint8_t number) const {
    return attempt(to_parameter(quantity_, units_, *find_parameter(units_.parameters(), number)));
  }

 private:
  /// What a second adds to an acceleration.
  std::vector<Rendering> forms_of(tmcl::PulsesPerSecond3 jerk) const {
    const tmcl::PulsesPerSecond2 change{jerk.value};
    return {{"pps3", "pps/s^2", jerk.value},
            {"full_steps_per_second3", "full steps/s^3", to_user(change, full_steps()).value},
            {"rps3", "rps/s^2", to_user(change, turns()).value}};
  }
  tmcl::UserScale turns() const { return tmcl::revolutions(*units_.scale); }
  tmcl::UserScale full_steps() const {
    auto scale = turns();
    scale.units_per_revolution = scale.steps.full_steps;
    return scale;
  }

  Quantity quantity_;
  AxisUnits units_;
};

void print(std::string_view title, const std::vector<Rendering>& forms, Output& output) {
  output.out << title << '\n';
  for (const auto& form : forms)
    output.out << fmt::format("  {:>16} {}\n", tmcl::plain_number(form.value, 10), form.unit);
}

/// What is to be shown of it, as the user said it.
struct Shown {
  const char* key;
  const char* title;
  Result<std::vector<Rendering>> forms;
};

/// The velocity, the acceleration, and the ramp that they make.
std::vector<Shown> ramp_of(const verb::Convert& verb, const Quantity& velocity,
                           const AxisUnits& units) {
  const auto acceleration = attempt(tmcl::parse_quantity(verb.acceleration));
  if (!acceleration) return {{"ramp", "", tl::unexpected(acceleration.error())}};
  const Converter reached(velocity, units);
  return {{"velocity", "a velocity", reached.velocity()},
          {"acceleration", "an acceleration", Converter(*acceleration, units).acceleration()},
          {"ramp", "from rest to this velocity, or back", reached.ramp(*acceleration, verb.bow)}};
}

/// Why a number without a unit is none of this: nothing where its register holds it.
std::optional<std::string> out_of_register(const Quantity& quantity, const AxisUnits& units,
                                           std::uint8_t parameter) {
  const auto* row = find_parameter(units.parameters(), parameter);
  if (row == nullptr) return std::nullopt;
  const auto range = range_of(*row, tmcl::initial_units(*units.model), *units.module);
  if (quantity.number >= range.least && quantity.number <= range.greatest) return std::nullopt;
  return fmt::format("{} ({}) holds {} to {}", row->name, row->number, range.least, range.greatest);
}

Shown shown_as(const Converter& converter, std::uint8_t parameter) {
  if (parameter == ap::target_position) return {"position", "a position", converter.position()};
  if (parameter == ap::target_velocity) return {"velocity", "a velocity", converter.velocity()};
  return {"acceleration", "an acceleration", converter.acceleration()};
}

/// All that a number without a unit can be. `others`: what it cannot.
Result<std::vector<Shown>> every_meaning(const Quantity& quantity, const AxisUnits& units,
                                         std::vector<std::string>& others) {
  const Converter converter(quantity, units);
  std::vector<Shown> all;
  for (const auto parameter : {ap::target_position, ap::target_velocity, ap::max_acceleration}) {
    const auto why_not = out_of_register(quantity, units, parameter);
    auto shown = shown_as(converter, parameter);
    if (why_not) {
      others.push_back(fmt::format("no {}: {}", shown.key, *why_not));
    } else {
      all.push_back(std::move(shown));
    }
  }
  if (!all.empty()) return all;
  return tl::unexpected(usage_error(
      "out_of_range", fmt::format("no register {} holds {}: it is {}", units.axis,
                                  tmcl::plain_number(quantity.number), fmt::join(others, ", "))));
}

Result<std::vector<Shown>> what_to_show(const verb::Convert& verb, const Quantity& quantity,
                                        const AxisUnits& units, std::vector<std::string>& others) {
  if (!verb.acceleration.empty()) return ramp_of(verb, quantity, units);
  const Converter converter(quantity, units);
  if (verb.bow) return std::vector<Shown>{{"jerk", "a bow", converter.bow(*verb.bow)}};
  if (is_jerk(quantity)) return std::vector<Shown>{{"jerk", "a jerk", converter.jerk()}};
  switch (dimension_of(quantity)) {
    case tmcl::Dimension::other: return every_meaning(quantity, units, others);
    case tmcl::Dimension::position: return std::vector{shown_as(converter, ap::target_position)};
    case tmcl::Dimension::velocity: return std::vector{shown_as(converter, ap::target_velocity)};
    case tmcl::Dimension::acceleration: break;
  }
  return std::vector{shown_as(converter, ap::max_acceleration)};
}

/// What the twin of such a module says of the ramp.
std::vector<std::string> warnings_of_ramp(const verb::Convert& verb, const Quantity& velocity,
                                          const AxisUnits& units) {
  const auto acceleration = attempt(tmcl::parse_quantity(verb.acceleration));
  auto twin = tmcl::plan::AxisTwin::of(*units.model);
  if (verb.acceleration.empty() || !acceleration || !twin) return {};
  std::vector<tmcl::plan::Setting> settings;
  if (verb.unit_mode) settings.push_back({ap::unit_mode, *verb.unit_mode});
  if (verb.pulse_div) settings.push_back({tmcl::number_of("pulse_divisor"), *verb.pulse_div});
  if (verb.ramp_div) settings.push_back({tmcl::number_of("ramp_divisor"), *verb.ramp_div});
  const auto v = Converter(velocity, units).parameter(ap::max_velocity);
  const auto a = Converter(*acceleration, units).parameter(ap::max_acceleration);
  if (!a) return {};
  if (v) settings.push_back({ap::max_velocity, *v});
  if (units.model->family == tmcl::Family::tmc457) {
    settings.push_back({tmcl::number_of("acceleration"), *a});
    settings.push_back({tmcl::number_of("max_deceleration"), *a});
  } else {
    settings.push_back({ap::max_acceleration, *a});
  }
  if (verb.bow) settings.push_back({tmcl::number_of("max_bow"), *verb.bow});
  if (!twin->set(settings)) return {};
  twin->move_to({});
  return twin->warnings(settings);
}

Result<ExitCode> run(const verb::Convert& verb, Output& output) {
  const auto model = parse_model(verb.model);
  if (!model) return tl::unexpected(model.error());
  if (verb.bow && (*model)->family != tmcl::Family::tmc457) {
    return tl::unexpected(
        usage_error("usage", fmt::format("convert: --bow means nothing to a {}", (*model)->name)));
  }
  const auto quantity = attempt(tmcl::parse_quantity(verb.quantity.empty() ? "0" : verb.quantity));
  if (!quantity) return tl::unexpected(quantity.error());
  AxisUnits units{"", *model, {}, tmcl::UserScale{}};
  const auto module = units_of(verb, **model, units.parameters());
  if (!module) return tl::unexpected(module.error());
  units.axis = "of a " + std::string((*model)->name);
  units.module = *module;
  units.scale->unit.clear();
  units.scale->steps = {verb.full_steps, static_cast<std::int32_t>(std::log2(verb.microsteps))};

  json::object document{{"model", (*model)->name}};
  std::vector<std::string> others;
  const auto all = what_to_show(verb, *quantity, units, others);
  if (!all) return tl::unexpected(all.error());
  for (const auto& [key, title, forms] : *all) {
    if (!forms) return tl::unexpected(forms.error());
    if (output.json) {
      document[key] = to_object(*forms);
    } else {
      print(title, *forms, output);
    }
  }
  if (output.json) print_json(document, output);
  for (const auto& other : others)
    if (!output.json) output.out << other << '\n';
  warn(warnings_of_ramp(verb, *quantity, units), output);
  return ExitCode::done;
}

Reading read_microsteps(const std::string& text, std::int32_t& into) {
  const auto value = parse_number<std::int32_t>(text, 1, 1 << tmcl::max_microstep_resolution);
  if (!value) return tl::unexpected(value.error());
  if (!std::has_single_bit(static_cast<std::uint32_t>(*value)))
    return tl::unexpected(fmt::format("{} is no power of two", text));
  into = *value;
  return {};
}

constexpr const char* convert_help = R"(
Rounds to what such a module can hold, and shows that in all units. A bare number counts in the
module's own unit, and is shown as a position, a velocity and an acceleration: all that a register
holds it as. Dividers and unit mode are those that the model starts with, if they are not given. With
--acceleration QUANTITY is a velocity, and the time and the length of the ramp from rest to it are
shown: S-shaped with --bow. A bow that is too great for the acceleration is a warning; 0 is none.

  tmclctl convert --model TMCM-1110 61035pps
  tmclctl convert --model TMCM-1110 --pulse-div 5 --ramp-div 7 500
  tmclctl convert --model TMCM-6212 --microsteps 64 2rps
  tmclctl convert --model TMCM-142 --bow 11
  tmclctl convert --model TMCM-142 1000000pps/s^2
  tmclctl convert --model TMCM-142 40000pps --acceleration 400000pps/s --bow 9
)";

}  // namespace

void add_offline_axis(Form& form, verb::OfflineAxis& into) {
  constexpr double least_of_turn = 1e-9;
  constexpr double most_of_turn = 1e9;
  form.option("--model", "MODEL", "Of an axis that need not be there, such as TMCM-142",
              text(into.model));
  auto& microsteps = into.microsteps;
  form.option("--microsteps", "N", "With --model: of a full step (as the model starts)",
              [&microsteps](const std::string& text) {
                return read_microsteps(text, microsteps.emplace());
              });
  form.option("--full-steps", "N", "With --model: of a turn (default 200)",
              number(into.full_steps, 1, tmcl::max_full_steps));
  form.option("--screw-pitch", "UNITS", "With --model: what a turn of its screw is, in mm",
              number(into.screw_pitch, least_of_turn, most_of_turn));
  form.option("--units-per-revolution", "UNITS", "With --model: the same of what turns",
              number(into.units_per_revolution, least_of_turn, most_of_turn));
  form.option("--unit", "UNIT", "With --model: what those are (default mm)", text(into.unit));
  form.option("--gear-ratio", "N", "With --model: turns of the motor for one behind the gear",
              number(into.gear_ratio, least_of_turn, most_of_turn));
}

std::string objection_to(const verb::OfflineAxis& axis) {
  const bool has_more = axis.microsteps || axis.has_scale() || !axis.unit.empty() ||
                        axis.gear_ratio != 1 || axis.full_steps != 200;
  if (!axis.is_meant()) return has_more ? "what a turn is needs --model MODEL" : "";
  if (axis.screw_pitch && axis.units_per_revolution)
    return "--screw-pitch and --units-per-revolution say the same: give one";
  return axis.unit.empty() || axis.has_scale()
             ? ""
             : "--unit needs --screw-pitch or --units-per-revolution";
}

void add_convert(Grammar& grammar) {
  auto convert = grammar.verb<verb::Convert>(
      "convert", access::offline("it computes, and asks no module"),
      "Show a quantity in all its units, without any module", convert_help, run);
  convert.optional_word("QUANTITY",
                        "Such as 500, 61035pps, 2rps, 1.5rev, 100000pps/s or 1e6pps/s^2",
                        text(convert->quantity));
  convert.required_option("--model", "MODEL", "Such as TMCM-1110", text(convert->model));
  convert.option("--pulse-div", "N", "Pulse divider (parameter 154) of a TMC429",
                 number(convert->pulse_div, 0, tmcl::tmc429_max_divider));
  convert.option("--ramp-div", "N", "Its ramp divider (parameter 153)",
                 number(convert->ramp_div, 0, tmcl::tmc429_max_divider));
  convert.option("--unit-mode", "MODE", "Parameter 255 of other chips",
                 number(convert->unit_mode, 0, 1));
  auto& microsteps = convert->microsteps;
  convert.option(
      "--microsteps", "N", "Microsteps of a full step (default 256)",
      [&microsteps](const std::string& text) { return read_microsteps(text, microsteps); });
  convert.option("--bow", "N", "A bow of a TMC457 (parameter 18) instead of a quantity",
                 number(convert->bow, 0, tmcl::greatest_bow));
  convert.option("--acceleration", "ACCELERATION",
                 "Time and length of the ramp to QUANTITY, a velocity; S-shaped with --bow",
                 text(convert->acceleration));
  convert.object(
      [](const verb::Convert& said, bool) -> std::string {
        if (!said.acceleration.empty())
          return said.quantity.empty() ? "--acceleration is of the ramp to a velocity" : "";
        return said.quantity.empty() == said.bow.has_value() ? "" : "give QUANTITY or --bow";
      },
      "such as 'tmclctl convert --model TMCM-142 --bow 11'");
  convert.option("--full-steps", "N", "Full steps of a turn (default 200)",
                 number(convert->full_steps, 1, tmcl::max_full_steps));
}

}  // namespace tmclctl

// ramp, convert.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "names.hpp"
#include "print.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace ap = tmcl::axis_parameter;
using tmcl::plan::RampChoice;
using tmcl::plan::Setting;

// ---- ramp ----

Failure unknown_model(const std::string& axis) {
  return usage_failure("unknown_model",
                       fmt::format("the model of axis {} is not known, so what its parameters "
                                   "mean is not, either",
                                   axis));
}

Attempt<RampChoice> choose_ramp(const verb::Ramp& verb, const AxisUnits& units) {
  if (units.model == nullptr || !units.module) return tl::unexpected(unknown_model(verb.axis));
  // A ramp is the same in both directions.
  const auto undirected = units.undirected();
  auto counted = undirected;
  if (verb.internal) counted.scale.reset();
  const auto said_velocity = attempt(tmcl::parse_quantity(verb.velocity));
  if (!said_velocity) return tl::unexpected(said_velocity.error());
  const auto said_acceleration = attempt(tmcl::parse_quantity(verb.acceleration));
  if (!said_acceleration) return tl::unexpected(said_acceleration.error());
  const auto velocity =
      attempt(to_pps(*said_velocity, said_velocity->unit.empty() ? counted : undirected));
  if (!velocity) return tl::unexpected(velocity.error());
  const auto acceleration =
      attempt(to_pps2(*said_acceleration, said_acceleration->unit.empty() ? counted : undirected));
  if (!acceleration) return tl::unexpected(acceleration.error());
  const auto choice = tmcl::plan::choose_ramp(
      *units.model, {*velocity, *acceleration, *acceleration}, *units.module);
  if (choice) return *choice;
  const auto& [is_velocity, error] = choice.error();
  return tl::unexpected(failure_from(
      out_of_reach(is_velocity ? *said_velocity : *said_acceleration, undirected, error)));
}

// The table has a row for everything that is chosen from it.
std::string_view name_of(Setting setting, const AxisUnits& units) {
  return find_parameter(units.parameters(), setting.parameter)->name;
}

Attempt<void> refuse_in_motion(const std::string& axis, Target& target) {
  const auto state = target.state(axis);
  if (!state) return tl::unexpected(state.error());
  if (!state->moving) return {};
  Failure failure = usage_failure("moving",
                                  fmt::format("axis {} moves; a ramp is changed at standstill, and "
                                              "nothing was written",
                                              axis),
                                  "'tmclctl stop " + axis + "' stops it");
  failure.exit = ExitCode::refused;
  return tl::unexpected(std::move(failure));
}

Attempt<void> write(const std::vector<Setting>& settings, const AxisUnits& units,
                    const std::string& axis, Target& target) {
  std::string written;
  for (const auto& setting : settings) {
    const auto set = target.set(axis, std::to_string(setting.parameter), setting.value);
    const auto assignment = fmt::format("{} = {}", name_of(setting, units), setting.value);
    if (!set) {
      auto failure = set.error();
      failure.message += "; it was about " + assignment;
      if (!written.empty()) failure.message += ", and these were written before: " + written;
      return tl::unexpected(std::move(failure));
    }
    written += (written.empty() ? "" : ", ") + assignment;
  }
  return {};
}

struct RampInUnit {
  InUnit velocity;
  InUnit acceleration;
};

// Nothing for an axis without a unit.
std::optional<RampInUnit> in_unit(const RampChoice& choice, const AxisUnits& units) {
  if (!units.scale || units.scale->unit.empty()) return std::nullopt;
  auto undirected = *units.scale;
  undirected.reverse = false;
  return RampInUnit{{to_user(choice.velocity, undirected).value, undirected.unit + "/s"},
                    {to_user(choice.acceleration, undirected).value, undirected.unit + "/s^2"}};
}

void show(const verb::Ramp& verb, const RampChoice& choice, const AxisUnits& units,
          Output& output) {
  const auto ramp = in_unit(choice, units);
  if (output.json) {
    json::object parameters;
    for (const auto& setting : choice.settings) parameters[name_of(setting, units)] = setting.value;
    print_json(
        {{"axis", verb.axis},
         {"model", units.model->name},
         {"velocity_pps", choice.velocity.value},
         {"acceleration_pps2", choice.acceleration.value},
         {"unit", ramp ? json::value(units.scale->unit) : json::value(nullptr)},
         {"velocity", ramp ? json::value(ramp->velocity.value) : json::value(nullptr)},
         {"acceleration", ramp ? json::value(ramp->acceleration.value) : json::value(nullptr)},
         {"parameters", std::move(parameters)},
         {"remarks", json::array(choice.remarks.begin(), choice.remarks.end())},
         {"written", !verb.dry_run}},
        output);
    return;
  }
  for (const auto& setting : choice.settings)
    output.out << fmt::format("{:<18} {}\n", name_of(setting, units), setting.value);
  output.out << "gives "
             << (ramp && !verb.internal
                     ? shown(ramp->velocity, choice.velocity.value) + " and " +
                           shown(ramp->acceleration, choice.acceleration.value)
                     : fmt::format("{:.10g} pps and {:.10g} pps/s", choice.velocity.value,
                                   choice.acceleration.value))
             << (verb.dry_run ? "; nothing was written" : "") << '\n';
  for (const auto& remark : choice.remarks) output.err << "tmclctl: warning: " << remark << '\n';
}

/// The order in which to write them to an axis that stands, with what its module has now.
Attempt<std::vector<Setting>> in_safe_order(std::vector<Setting> settings, const std::string& axis,
                                            Target& target) {
  constexpr auto pulse_divisor = tmcl::number_of("pulse_divisor");
  if (std::ranges::find(settings, pulse_divisor, &Setting::parameter) == settings.end())
    return settings;
  return target.get(axis, std::to_string(pulse_divisor)).map([&](const ParameterValue& present) {
    return tmcl::plan::in_safe_order(std::move(settings), present.value);
  });
}

}  // namespace

VerbResult run(const verb::Ramp& verb, Context& context) {
  const auto units = context.target.units(verb.axis);
  if (!units) return tl::unexpected(units.error());
  const auto choice = choose_ramp(verb, *units);
  if (!choice) return tl::unexpected(choice.error());
  if (!verb.dry_run) {
    const auto done =
        refuse_in_motion(verb.axis, context.target)
            .and_then([&] { return in_safe_order(choice->settings, verb.axis, context.target); })
            .and_then([&](const std::vector<Setting>& settings) {
              return write(settings, *units, verb.axis, context.target);
            });
    if (!done) return tl::unexpected(done.error());
  }
  show(verb, *choice, *units, context.output);
  return ExitCode::done;
}

// ---- convert ----

namespace {

/// The settings that a model has, over what it starts with.
Attempt<tmcl::ModuleUnits> units_of(const verb::Convert& verb, const tmcl::Model& model,
                                    std::span<const tmcl::ParameterInfo> table) {
  const auto numbers = tmcl::unit_parameters(model);
  std::vector<std::int32_t> values;
  for (const auto number : numbers) values.push_back(find_parameter(table, number)->initial);
  const auto refusal = [&](std::string_view option) {
    return tl::unexpected(usage_failure(
        "usage", fmt::format("convert: {} means nothing to a {}", option, model.name)));
  };
  const bool has_dividers = numbers.size() == 2;
  const bool has_mode = numbers.size() == 1;
  if (verb.pulse_div && !has_dividers) return refusal("--pulse-div");
  if (verb.ramp_div && !has_dividers) return refusal("--ramp-div");
  if (verb.unit_mode && !has_mode) return refusal("--unit-mode");
  if (has_dividers)
    values = {verb.pulse_div.value_or(values[0]), verb.ramp_div.value_or(values[1])};
  if (has_mode) values = {verb.unit_mode.value_or(values[0])};
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

  Attempt<std::vector<Rendering>> position() const {
    return parameter(ap::target_position).map([&](std::int32_t value) {
      const tmcl::Microsteps at{value};
      return std::vector<Rendering>{{"microsteps", "microsteps", static_cast<double>(value)},
                                    {"full_steps", "full steps", to_user(at, full_steps()).value},
                                    {"revolutions", "rev", to_user(at, turns()).value}};
    });
  }
  Attempt<std::vector<Rendering>> velocity() const {
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
  Attempt<std::vector<Rendering>> acceleration() const {
    return parameter(ap::max_acceleration).map([&](std::int32_t value) {
      const auto pps2 = to_pps2(tmcl::InternalAcceleration{value}, *units_.module);
      return std::vector<Rendering>{
          {"internal", "in the module's unit", static_cast<double>(value)},
          {"pps2", "pps/s", pps2.value},
          {"full_steps_per_second2", "full steps/s^2", to_user(pps2, full_steps()).value},
          {"rps2", "rps/s", to_user(pps2, turns()).value}};
    });
  }

 private:
  tmcl::UserScale turns() const { return tmcl::revolutions(*units_.scale); }
  tmcl::UserScale full_steps() const {
    auto scale = turns();
    scale.units_per_revolution = scale.steps.full_steps;
    return scale;
  }
  Attempt<std::int32_t> parameter(std::uint8_t number) const {
    return attempt(to_parameter(quantity_, units_, *find_parameter(units_.parameters(), number)));
  }

  Quantity quantity_;
  AxisUnits units_;
};

void print(std::string_view title, const std::vector<Rendering>& forms, Output& output) {
  output.out << title << '\n';
  for (const auto& form : forms)
    output.out << fmt::format("  {:>16.10g} {}\n", form.value, form.unit);
}

}  // namespace

VerbResult run(const verb::Convert& verb, Output& output) {
  const auto model = parse_model(verb.model);
  if (!model) return tl::unexpected(model.error());
  const auto quantity = attempt(tmcl::parse_quantity(verb.quantity));
  if (!quantity) return tl::unexpected(quantity.error());
  AxisUnits units{"", *model, {}, tmcl::UserScale{}};
  const auto module = units_of(verb, **model, units.parameters());
  if (!module) return tl::unexpected(module.error());
  units.axis = "of a " + std::string((*model)->name);
  units.module = *module;
  units.scale->unit.clear();
  units.scale->steps = {verb.full_steps, static_cast<std::int32_t>(std::log2(verb.microsteps))};

  const Converter converter(*quantity, units);
  const auto dimension = dimension_of(*quantity);
  json::object document{{"model", (*model)->name}};
  const auto add = [&](tmcl::Dimension which, const char* key, const char* title,
                       const auto& convert) -> Attempt<void> {
    if (dimension != tmcl::Dimension::other && dimension != which) return {};
    return convert().map([&](const std::vector<Rendering>& forms) {
      if (output.json) {
        document[key] = to_object(forms);
      } else {
        print(title, forms, output);
      }
    });
  };
  const auto added =
      add(tmcl::Dimension::position, "position", "a position", [&] { return converter.position(); })
          .and_then([&] {
            return add(tmcl::Dimension::velocity, "velocity", "a velocity",
                       [&] { return converter.velocity(); });
          })
          .and_then([&] {
            return add(tmcl::Dimension::acceleration, "acceleration", "an acceleration",
                       [&] { return converter.acceleration(); });
          });
  if (!added) return tl::unexpected(added.error());
  if (output.json) print_json(document, output);
  return ExitCode::done;
}

}  // namespace tmclctl

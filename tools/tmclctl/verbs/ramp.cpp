// ramp.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "names.hpp"
#include "print.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using tmcl::Quantity;
using tmcl::plan::RampChoice;
using tmcl::plan::RampRequest;
using tmcl::plan::Setting;

constexpr auto max_bow = tmcl::number_of("max_bow");

Failure unknown_model(const std::string& axis) {
  return usage_failure("unknown_model",
                       fmt::format("the model of axis {} is not known, so what its parameters "
                                   "mean is not, either",
                                   axis));
}

/// What was typed, in microsteps and seconds. A ramp is the same in both directions.
class Wish {
 public:
  Wish(const verb::Ramp& verb, const AxisUnits& units)
      : verb_(verb), with_unit_(units.undirected()), bare_(with_unit_) {
    if (verb.internal) bare_.scale.reset();
  }

  Attempt<RampRequest> read(std::int32_t bow) {
    RampRequest request{{}, {}, {}, std::nullopt, bow};
    velocity_ = parse(verb_.velocity);
    acceleration_ = parse(verb_.acceleration);
    deceleration_ = verb_.deceleration.empty() ? acceleration_ : parse(verb_.deceleration);
    take(velocity_, tmcl::to_pps, request.velocity);
    take(acceleration_, tmcl::to_pps2, request.acceleration);
    take(deceleration_, tmcl::to_pps2, request.deceleration);
    if (verb_.jerk == "max") request.jerk = tmcl::plan::highest_jerk;
    if (!verb_.jerk.empty() && verb_.jerk != "max") take_jerk(request);
    if (wrong_) return tl::unexpected(std::move(*wrong_));
    return request;
  }
  /// Which of them the module does not have.
  Failure too_far(const tmcl::RampOutOfReach& fault, const RampRequest& request) const {
    const auto off = [&](tmcl::PulsesPerSecond2 from) {
      return std::abs(fault.error.wished - from.value);
    };
    const bool is_braking = off(request.deceleration) < off(request.acceleration);
    const auto& said = fault.is_velocity ? velocity_ : is_braking ? deceleration_ : acceleration_;
    return failure_from(out_of_reach(said, with_unit_, fault.error));
  }

 private:
  Quantity parse(const std::string& text) {
    auto quantity = attempt(tmcl::parse_quantity(text));
    if (quantity) return *quantity;
    if (!wrong_) wrong_ = std::move(quantity.error());
    return {};
  }
  const AxisUnits& units_for(const Quantity& quantity) const {
    return quantity.unit.empty() ? bare_ : with_unit_;
  }
  template <class Value>
  void take(const Quantity& quantity,
            tmcl::Converted<Value> (*convert)(const Quantity&, const AxisUnits&), Value& into) {
    if (wrong_) return;
    auto value = attempt(convert(quantity, units_for(quantity)));
    if (!value) wrong_ = std::move(value.error());
    if (value) into = *value;
  }
  // A bare number is what the module counts in: its bow.
  void take_jerk(RampRequest& request) {
    const auto quantity = parse(verb_.jerk);
    if (wrong_) return;
    if (!quantity.unit.empty()) {
      tmcl::PulsesPerSecond3 jerk;
      take(quantity, tmcl::to_pps3, jerk);
      if (jerk.value > 0) request.jerk = jerk.value;
      if (!wrong_ && !request.jerk)
        wrong_ = usage_failure("out_of_range", "the jerk must be greater than 0");
      return;
    }
    if (bare_.has_unit()) {
      wrong_ =
          usage_failure("bare_number", "'" + verb_.jerk + "' has no unit, and the axis has one",
                        verb_.jerk + with_unit_.scale->unit + "/s^3 or " + verb_.jerk + "pps/s^2");
      return;
    }
    const bool is_bow = quantity.number == std::trunc(quantity.number) && quantity.number >= 1 &&
                        quantity.number <= tmcl::greatest_bow;
    if (!is_bow) {
      wrong_ = usage_failure("out_of_range",
                             fmt::format("'{}' is no bow: without a unit a jerk is one of 1 to {}",
                                         verb_.jerk, tmcl::greatest_bow));
      return;
    }
    request.jerk = tmcl::to_pps3(static_cast<std::int32_t>(quantity.number)).value;
  }

  const verb::Ramp& verb_;
  AxisUnits with_unit_;
  AxisUnits bare_;
  Quantity velocity_, acceleration_, deceleration_;
  std::optional<Failure> wrong_;
};

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

/// What all of them make of moves.
Attempt<Warnings> write(const std::vector<Setting>& settings, const AxisUnits& units,
                        const std::string& axis, Target& target) {
  std::string written;
  Warnings warnings;
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
    warnings = set->warnings;
  }
  return warnings;
}

tmcl::RampLength ramp_up(const RampChoice& choice) {
  return tmcl::ramp_length(choice.velocity, choice.acceleration, {choice.jerk});
}

/// What comes of a move that gets up to speed. A TMC429 whose ramp ticks are long may pass its
/// target again and again, whatever its data sheet allows.
Warnings foreseen(const RampChoice& choice, const tmcl::Model& model) {
  constexpr double farthest = 8e6;
  if (model.family != tmcl::Family::tmc429) return {};
  auto twin = tmcl::plan::AxisTwin::of(model);
  if (!twin || !twin->set(choice.settings)) return {};
  const double way = std::min(3 * ramp_up(choice).microsteps + 1, farthest);
  twin->move_to({static_cast<std::int32_t>(way)});
  if (twin->time_to_arrival()) return {};
  return {
      "with these settings a move may not come to rest on its target; another acceleration does"};
}

/// One quantity of the ramp, as microsteps and in the unit of the axis.
struct Rate {
  std::string_view name;         // in JSON
  std::string_view name_in_pps;  // likewise
  double pps;
  std::string in_pps;
  std::string per_seconds;
};

constexpr std::string_view deceleration = "deceleration";

bool brakes_as_it_speeds_up(const RampChoice& choice) {
  constexpr double noticeable = 1e-3;
  return std::abs(choice.deceleration.value / choice.acceleration.value - 1) < noticeable;
}

std::vector<Rate> rates_of(const RampChoice& choice) {
  std::vector<Rate> rates{
      {"velocity", "velocity_pps", choice.velocity.value, "pps", "/s"},
      {"acceleration", "acceleration_pps2", choice.acceleration.value, "pps/s", "/s^2"},
      {deceleration, "deceleration_pps2", choice.deceleration.value, "pps/s", "/s^2"}};
  if (std::isfinite(choice.jerk))
    rates.push_back({"jerk", "jerk_pps3", choice.jerk, "pps/s^2", "/s^3"});
  return rates;
}

/// How many of the axis' unit a microstep is; nothing without a unit.
std::optional<double> unit_per_microstep(const AxisUnits& units) {
  if (!units.has_unit()) return std::nullopt;
  auto undirected = *units.scale;
  undirected.reverse = false;
  return to_user(tmcl::PulsesPerSecond{1}, undirected).value;
}

json::object to_json(const verb::Ramp& verb, const RampChoice& choice, const AxisUnits& units,
                     const Warnings& warnings) {
  json::object parameters;
  for (const auto& setting : choice.settings) parameters[name_of(setting, units)] = setting.value;
  const auto unit = unit_per_microstep(units);
  const auto [seconds, microsteps] = ramp_up(choice);
  json::object document{{"axis", verb.axis},
                        {"model", units.model->name},
                        {"unit", unit ? json::value(units.scale->unit) : json::value(nullptr)}};
  for (const auto& rate : rates_of(choice)) {
    document[rate.name_in_pps] = rate.pps;
    document[rate.name] = unit ? json::value(rate.pps * *unit) : json::value(nullptr);
  }
  document["ramp_s"] = seconds;
  document["ramp_microsteps"] = microsteps;
  document["parameters"] = std::move(parameters);
  document["remarks"] = json::array(choice.remarks.begin(), choice.remarks.end());
  document["warnings"] = json::array(warnings.begin(), warnings.end());
  document["written"] = !verb.dry_run;
  return document;
}

void show(const verb::Ramp& verb, const RampChoice& choice, const AxisUnits& units,
          const Warnings& warnings, Output& output) {
  warn(warnings, output);
  if (output.json) return print_json(to_json(verb, choice, units, warnings), output);
  for (const auto& setting : choice.settings)
    output.out << fmt::format("{:<18} {}\n", name_of(setting, units), setting.value);
  const auto unit = verb.internal ? std::nullopt : unit_per_microstep(units);
  std::string text;
  for (const auto& rate : rates_of(choice)) {
    if (rate.name == deceleration && brakes_as_it_speeds_up(choice)) continue;
    text += text.empty() ? "gives " : ", ";
    text += unit ? shown(InUnit{rate.pps * *unit, units.scale->unit + rate.per_seconds}, rate.pps)
                 : fmt::format("{:.10g} {}", rate.pps, rate.in_pps);
  }
  const auto [seconds, microsteps] = ramp_up(choice);
  output.out << text
             << fmt::format("; up to speed in {:.4g} s and {:.0f} microsteps", seconds, microsteps)
             << (verb.dry_run ? "; nothing was written" : "") << '\n';
  warn(choice.remarks, output);
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

/// 0 for a module without one.
Attempt<std::int32_t> present_bow(const std::string& axis, const AxisUnits& units, Target& target) {
  if (units.model->family != tmcl::Family::tmc457) return 0;
  return target.get(axis, std::to_string(max_bow)).map([](const ParameterValue& read) {
    return read.value;
  });
}

}  // namespace

VerbResult run(const verb::Ramp& verb, Context& context) {
  const auto units = context.target.units(verb.axis);
  if (!units) return tl::unexpected(units.error());
  if (units->model == nullptr || !units->module) return tl::unexpected(unknown_model(verb.axis));
  const auto bow = present_bow(verb.axis, *units, context.target);
  if (!bow) return tl::unexpected(bow.error());
  Wish wish(verb, *units);
  const auto request = wish.read(*bow);
  if (!request) return tl::unexpected(request.error());
  const auto choice = tmcl::plan::choose_ramp(*units->model, *request, *units->module);
  if (!choice) return tl::unexpected(wish.too_far(choice.error(), *request));
  auto warnings = foreseen(*choice, *units->model);
  if (!verb.dry_run) {
    const auto done =
        refuse_in_motion(verb.axis, context.target)
            .and_then([&] { return in_safe_order(choice->settings, verb.axis, context.target); })
            .and_then([&](const std::vector<Setting>& settings) {
              return write(settings, *units, verb.axis, context.target);
            });
    if (!done) return tl::unexpected(done.error());
    warnings.insert(warnings.end(), done->begin(), done->end());
  }
  show(verb, *choice, *units, warnings, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl

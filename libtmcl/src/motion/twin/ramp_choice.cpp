#include "tmcl/plan/ramp_choice.hpp"

#include <algorithm>
#include <cmath>

#include "motion/twin/divisors.hpp"
#include "tmcl/jerk.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

constexpr auto minimum_velocity = number_of("minimum_velocity");
constexpr double noticeable = 0.01;  // of a wish

std::string in_words(double value, const WishUnit& unit) {
  const auto number = plain_number(value * unit.per_microstep, 6);
  return unit.name.empty() ? number : number + ' ' + unit.name;
}

void remark_if_off(RampChoice& choice, const char* what, double wished, double got,
                   const WishUnit& unit) {
  if (std::abs(got - wished) <= noticeable * wished) return;
  choice.remarks.push_back("the " + std::string(what) + " is " + in_words(got, unit) + ", not " +
                           in_words(wished, unit));
}

void remark(RampChoice& choice, const RampRequest& wish) {
  const auto& units = wish.said_in;
  remark_if_off(choice, "velocity", wish.velocity.value, choice.velocity.value, units.velocity);
  remark_if_off(choice, "acceleration", wish.acceleration.value, choice.acceleration.value,
                units.acceleration);
  remark_if_off(choice, "deceleration", wish.deceleration.value, choice.deceleration.value,
                units.deceleration);
  if (!wish.jerk || std::isinf(*wish.jerk)) return;
  if (std::isinf(choice.jerk)) {
    choice.remarks.push_back(
        "the acceleration begins and ends at once: the module makes no S-shaped "
        "ramps");
  } else if (*wish.jerk != highest_jerk) {
    remark_if_off(choice, "jerk", *wish.jerk, choice.jerk, units.jerk);
  }
}

// ---- TMC429 ----

Reached<RampChoice> choose_for_tmc429(const RampRequest& wish) {
  const auto ramp = choose_tmc429_ramp(wish.velocity, wish.acceleration);
  if (!ramp) return tl::unexpected(ramp.error());
  RampChoice choice;
  choice.settings = {
      {pulse_divisor, ramp->dividers.pulse},
      {ramp_divisor, ramp->dividers.ramp},
      {ap::max_velocity, ramp->v_max.value},
      {ap::max_acceleration, ramp->a_max.value},
      {minimum_velocity,
       std::min(speed_within_a_microstep(ramp->dividers, ramp->a_max), ramp->v_max).value}};
  choice.velocity = ramp->velocity();
  choice.acceleration = choice.deceleration = ramp->acceleration();
  return choice;
}

// ---- modules whose ramps are parameters in one unit ----

/// Collects settings by the names of the parameters.
class Chooser {
 public:
  Chooser(const Model& model, const ModuleUnits& units)
      : model_(model), table_(axis_parameters(model)), units_(units) {}

  /// True if the model has such a parameter and it takes the value.
  bool set(std::string_view name, PulsesPerSecond velocity) {
    const auto* row = find(name);
    if (row == nullptr) return false;
    const auto value = to_internal(velocity, units_, positive(*row));
    if (!value) return fail(value.error());
    choice_.settings.push_back({row->number, value->value});
    choice_.velocity = to_pps(*value, units_);
    return true;
  }
  bool set(std::string_view name, PulsesPerSecond2 acceleration, PulsesPerSecond2& got) {
    const auto* row = find(name);
    if (row == nullptr) return false;
    const auto value = to_internal(acceleration, units_, positive(*row));
    if (!value) return fail(value.error());
    choice_.settings.push_back({row->number, value->value});
    got = to_pps2(*value, units_);
    return true;
  }

  RampChoice& choice() { return choice_; }
  Reached<RampChoice> take() {
    if (error_) return tl::unexpected(*error_);
    return std::move(choice_);
  }

 private:
  const ParameterInfo* find(std::string_view name) const { return find_parameter(table_, name); }
  // 0 is a motor that does not move.
  ValueRange positive(const ParameterInfo& row) const {
    const auto range = range_of(row, initial_units(model_), units_);
    return {std::max(range.least, 1), range.greatest};
  }
  bool fail(const OutOfReach& error) {
    if (!error_) error_ = error;
    return false;
  }

  const Model& model_;
  std::span<const ParameterInfo> table_;
  const ModuleUnits& units_;
  RampChoice choice_;
  std::optional<OutOfReach> error_;
};

/// The highest with which it does not swing, and that does not exceed the jerk; 1 at least.
std::int32_t choose_bow(double jerk, PulsesPerSecond2 least_acceleration) {
  if (std::isinf(jerk)) return 0;
  auto bow = bow_within({jerk});
  while (bow > 1 && may_oscillate(bow, least_acceleration)) --bow;
  return bow;
}

std::string too_high(std::int32_t bow) {
  return "with its bow of " + std::to_string(bow) +
         " the motor may swing around its target at these accelerations; a lower one does "
         "not";
}

Reached<RampChoice> choose_for_tmc457(const Model& model, const RampRequest& wish,
                                      const ModuleUnits& units) {
  constexpr double part_with_bow = 15.0 / 16;
  const auto least = std::min(wish.acceleration, wish.deceleration);
  const auto bow = wish.jerk ? choose_bow(*wish.jerk, least) : wish.bow;
  const double part = bow > 0 ? part_with_bow : 1;
  Chooser chooser(model, units);
  auto& choice = chooser.choice();
  chooser.set("max_velocity", wish.velocity);
  chooser.set("acceleration", wish.acceleration, choice.acceleration);
  chooser.set("max_deceleration", {wish.deceleration.value / part}, choice.deceleration);
  choice.deceleration.value *= part;
  if (wish.jerk) choice.settings.push_back({number_of("max_bow"), bow});
  if (bow > 0) choice.jerk = to_pps3(bow).value;
  if (may_oscillate(bow, least)) choice.remarks.push_back(too_high(bow));
  return chooser.take();
}

Reached<RampChoice> choose_for_others(const Model& model, const RampRequest& wish,
                                      const ModuleUnits& units) {
  Chooser chooser(model, units);
  auto& choice = chooser.choice();
  chooser.set("max_velocity", wish.velocity);
  for (const auto* name : {"max_acceleration", "acceleration_a1", "acceleration_a2"})
    chooser.set(name, wish.acceleration, choice.acceleration);
  choice.deceleration = choice.acceleration;
  for (const auto* name : {"max_deceleration", "deceleration_d1", "deceleration_d2"})
    chooser.set(name, wish.deceleration, choice.deceleration);
  return chooser.take();
}

Reached<RampChoice> choose(const Model& model, const RampRequest& wish, const ModuleUnits& units) {
  switch (model.family) {
    case Family::tmc429: return choose_for_tmc429(wish);
    case Family::tmc457: return choose_for_tmc457(model, wish, units);
    case Family::sixpoint:
    case Family::tmc4361:
    case Family::firmware: break;
  }
  return choose_for_others(model, wish, units);
}

}  // namespace

std::vector<Setting> in_safe_order(std::vector<Setting> settings, std::int32_t pulse_div) {
  const auto divider = std::ranges::find(settings, pulse_divisor, &Setting::parameter);
  if (divider == settings.end()) return settings;
  const bool gets_faster = divider->value < pulse_div;
  std::stable_partition(settings.begin(), settings.end(), [&](Setting setting) {
    const bool is_divider = setting.parameter == pulse_divisor || setting.parameter == ramp_divisor;
    return is_divider != gets_faster;
  });
  return settings;
}

InternalVelocity speed_within_a_microstep(Tmc429Dividers dividers,
                                          InternalAcceleration acceleration) {
  using R = ramp::Tmc429::Register;
  ramp::Tmc429 chip;
  chip.write(R::pulse_div, dividers.pulse);
  chip.write(R::ramp_div, dividers.ramp);
  chip.write(R::a_max, acceleration.value);
  const auto p = std::ldexp(128.0 + static_cast<double>(chip.read(R::pmul)),
                            -static_cast<int>(3 + chip.read(R::pdiv)));
  return {std::max(1, static_cast<std::int32_t>(std::sqrt(2048 * p)))};
}

OutOfReach in_unit(OutOfReach error, const WishUnit& unit) {
  return {error.wished * unit.per_microstep, error.nearest * unit.per_microstep, unit.name,
          error.fault};
}

std::optional<OutOfReach> jerk_out_of_reach(const Model& model, double jerk) {
  constexpr auto unit = "microsteps/s^3";
  if (std::isinf(jerk)) return std::nullopt;
  if (model.family != Family::tmc457)
    return OutOfReach{jerk, std::numeric_limits<double>::infinity(), unit, "a jerk without a bow"};
  const double least = to_pps3(1).value;
  if (jerk >= least) return std::nullopt;
  return OutOfReach{jerk, least, unit, "below the jerk of the smallest bow"};
}

Reached<RampChoice> choose_ramp(const Model& model, const RampRequest& wish,
                                const ModuleUnits& units) {
  return choose(model, wish, units).map([&](RampChoice choice) {
    remark(choice, wish);
    return choice;
  });
}

}  // namespace tmcl::plan

// ramp.
#include <cmath>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "output/print.hpp"
#include "tmcl/api/axis.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
using api::axis::Ramp;

template <class Method>
Method method_of(const verb::Ramp& verb) {
  const auto typed = [&](const std::string& text) { return Typed{text, verb.internal}; };
  Method method;
  method.axis = verb.axis;
  method.velocity = typed(verb.velocity).amount();
  method.velocity_internal = typed(verb.velocity).counted();
  method.acceleration = typed(verb.acceleration).amount();
  method.acceleration_internal = typed(verb.acceleration).counted();
  method.deceleration = typed(verb.deceleration).amount();
  method.deceleration_internal = typed(verb.deceleration).counted();
  method.jerk = typed(verb.jerk).amount();
  method.bow = typed(verb.jerk).counted();
  return method;
}

json::object to_json(const verb::Ramp& verb, const Ramp& ramp) {
  auto document = api::to_json(ramp);
  document["axis"] = verb.axis;
  document.erase(api::name_of<&Ramp::settings>());
  json::object parameters;
  for (const auto& setting : ramp.settings) parameters[setting.parameter] = setting.value;
  document["parameters"] = std::move(parameters);
  document["written"] = !verb.dry_run;
  return document;
}

/// One quantity of the ramp, in microsteps and in the unit of the axis.
struct Rate {
  double pulses;
  std::optional<double> in_unit;
  std::string_view in_pulses;
  std::string_view per_seconds;
};

std::vector<Rate> rates_of(const Ramp& ramp) {
  constexpr double noticeable = 1e-3;
  const auto difference = ramp.deceleration_pps2 / ramp.acceleration_pps2 - 1;
  std::vector<Rate> rates{{ramp.velocity_pps, ramp.velocity, "pps", "/s"},
                          {ramp.acceleration_pps2, ramp.acceleration, "pps/s", "/s^2"}};
  if (std::abs(difference) >= noticeable)
    rates.push_back({ramp.deceleration_pps2, ramp.deceleration, "pps/s", "/s^2"});
  if (ramp.jerk_pps3) rates.push_back({*ramp.jerk_pps3, ramp.jerk, "pps/s^2", "/s^3"});
  return rates;
}

void show(const verb::Ramp& verb, const Ramp& ramp, Output& output) {
  warn(ramp.warnings, output);
  if (output.json) return print_json(to_json(verb, ramp), output);
  for (const auto& setting : ramp.settings)
    output.out << fmt::format("{:<18} {}\n", setting.parameter, setting.value);
  std::string text;
  for (const auto& rate : rates_of(ramp)) {
    text += text.empty() ? "gives " : ", ";
    text +=
        rate.in_unit && !verb.internal
            ? shown(InUnit{*rate.in_unit, *ramp.unit + std::string(rate.per_seconds)}, rate.pulses)
            : fmt::format("{} {}", tmcl::plain_number(rate.pulses, 10), rate.in_pulses);
  }
  output.out << text
             << fmt::format("; up to speed in {} s and {:.0f} microsteps",
                            tmcl::plain_number(ramp.ramp_s, 4), ramp.ramp_microsteps)
             << (verb.dry_run ? "; nothing was written" : "") << '\n';
  warn(ramp.remarks, output);
}

Result<ExitCode> run(const verb::Ramp& verb, Context& context) {
  const auto ramp = verb.dry_run ? context.call(method_of<api::axis::PlanRamp>(verb))
                                 : context.call(method_of<api::axis::SetRamp>(verb));
  if (!ramp) return tl::unexpected(ramp.error());
  show(verb, *ramp, context.output);
  return ExitCode::done;
}

constexpr const char* ramp_help = R"(
On a module with a TMC429 it chooses pulse divider, ramp divider, max_velocity and max_acceleration so
that they come as near to the wish as the chip can, and a minimum_velocity with which the last
microstep takes no longer than the others; on other modules it sets max_velocity and all
accelerations of a ramp. It shows what they give, and refuses while the axis moves. A wish that
cannot be met is refused with the nearest value that can.
The dividers scale the other speeds of the axis, too, such as those of the reference search.

On a TMC457 --jerk makes S-shaped ramps: the greatest bow that does not exceed it and with which the
motor does not swing around its target; max is the greatest of these. A jerk below that of the
smallest bow, 909495pps/s^2, is refused, and so is any jerk but max on a module without bows. Without
--jerk the bow is left as it is, and 'tmclctl set x max_bow 0' switches it off. The last line says how long it takes to come
up to speed, and how far that is.

  tmclctl ramp x --velocity 50000pps --acceleration 200000pps/s
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --deceleration 50mm/s^2
  tmclctl ramp x --velocity 20mm/s --acceleration 100mm/s^2 --jerk max --dry-run
)";

}  // namespace

void add_ramp(Grammar& grammar) {
  auto ramp = grammar.verb<verb::Ramp>(
      "ramp", access::acts, "Choose and set registers for a velocity and an acceleration",
      ramp_help, run);
  ramp.axis(ramp->axis);
  ramp.required_option("--velocity", "VELOCITY", "Of positioning moves, such as 50000pps",
                       text(ramp->velocity));
  ramp.required_option("--acceleration", "ACCELERATION", "Of every ramp, such as 100mm/s^2",
                       text(ramp->acceleration));
  ramp.option("--deceleration", "ACCELERATION", "To brake with, where the module has it apart",
              text(ramp->deceleration));
  ramp.option("--jerk", "JERK",
              "How fast the acceleration changes, such as 500mm/s^3, or max; as it is without",
              text(ramp->jerk));
  ramp.flag("--dry-run", "Only show what would be set", ramp->dry_run);
  ramp.internal(ramp->internal);
}

}  // namespace tmclctl

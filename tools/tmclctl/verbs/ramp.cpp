// ramp.
#include <cmath>

#include <fmt/format.h>
#include <boost/json/object.hpp>

#include "output/print.hpp"
#include "profile/ramp_export.hpp"
#include "ramp_words.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace api = tmcl::api;
namespace plan = tmcl::plan;
using api::axis::Ramp;

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

}  // namespace

std::string gives_text(const verb::Ramp& verb, const Ramp& ramp) {
  std::string text;
  for (const auto& rate : rates_of(ramp)) {
    text += text.empty() ? "gives " : ", ";
    text +=
        rate.in_unit && !verb.internal
            ? shown(InUnit{*rate.in_unit, *ramp.unit + std::string(rate.per_seconds)}, rate.pulses)
            : fmt::format("{} {}", tmcl::plain_number(rate.pulses, 10), rate.in_pulses);
  }
  return text + fmt::format("; up to speed in {} s and {:.0f} microsteps",
                            tmcl::plain_number(ramp.ramp_s, 4), ramp.ramp_microsteps);
}

namespace {

void show(const verb::Ramp& verb, const Ramp& ramp, Output& output) {
  warn(ramp.warnings, output);
  if (output.json) return print_json(to_json(verb, ramp), output);
  for (const auto& setting : ramp.settings)
    output.out << fmt::format("{:<18} {}\n", setting.parameter, setting.value);
  output.out << gives_text(verb, ramp) << (verb.dry_run ? "; nothing was written" : "") << '\n';
  warn(ramp.remarks, output);
}

Reading read_form(const std::string& text, std::optional<profile::ExportForm>& into) {
  return profile::export_form(text).map([&](profile::ExportForm form) { into = form; });
}

Result<ExitCode> run(const verb::Ramp& verb, Context& context) {
  if (verb.compare) return compare_on_axis(verb, context);
  if (is_sought(verb)) return find_on_axis(verb, context);
  auto set = method_of<api::axis::SetRamp>(verb);
  if (verb.store) set.store = true;
  const auto ramp =
      verb.dry_run ? context.call(method_of<api::axis::PlanRamp>(verb)) : context.call(set);
  if (!ramp) return tl::unexpected(ramp.error());
  show(verb, *ramp, context.output);
  if (!verb.dry_run && !context.output.json)
    context.output.out << (verb.store
                               ? "it is stored: the module starts with it\n"
                               : "it holds until the module loses power: --store keeps it\n");
  return ExitCode::done;
}

Reading read_move_time(const std::string& text, std::optional<double>& seconds) {
  constexpr double least_s = 1e-6;
  constexpr double greatest_s = 86'400;
  double said_s = 0;
  return read_time(text, least_s, greatest_s, said_s).map([&] { seconds = said_s; });
}

/// 30%, or 0.3. A 30 alone is hardly meant as 3000%.
Reading read_margin(std::string text, double& margin) {
  constexpr double greatest_percent = 10'000;
  const bool in_percent = text.ends_with('%');
  if (in_percent) text.pop_back();
  const auto value = parse_number<double>(text, 0, greatest_percent);
  if (!value) return tl::unexpected(value.error());
  if (!in_percent && *value > 1)
    return tl::unexpected(fmt::format("{0} is a part above 1: give {0}%, or a part", text));
  margin = in_percent ? *value / 100 : *value;
  return {};
}

bool asks_for_torque(const plan::MotorTorque& motor) {
  return motor.load > 0 || motor.load_per_velocity > 0 || motor.inertia > 0;
}

std::string conflict_of_search(const verb::Ramp& said) {
  if (said.time_s && said.fastest) return "--time and --fastest exclude each other";
  if (!is_sought(said)) {
    if (has_figures(said.torque)) return "the figures of a motor need --fastest or --time";
    if (said.velocity.empty() || said.acceleration.empty())
      return "give --velocity and --acceleration, or --time or --fastest";
    return "";
  }
  if (said.compare) return "--compare and --time or --fastest exclude each other";
  if (said.distance.empty()) return "--time and --fastest need --distance";
  if (said.fastest && !asks_for_torque(said.torque))
    return "--fastest needs --load, --friction or --inertia: without a load only the chip bounds "
           "it";
  if (!said.acceleration.empty() || !said.deceleration.empty())
    return "--time and --fastest find the acceleration";
  return said.store ? "--store needs an axis that is set" : "";
}

std::string conflict_in(const verb::Ramp& said, bool json) {
  if (said.as && !said.offline.is_meant()) return "--as needs --model";
  if (said.as && json) return "--as and --json exclude each other";
  if (said.store && (said.offline.is_meant() || said.compare || said.dry_run))
    return "--store needs an axis that is set";
  if (said.as && said.compare) return "--as and --compare exclude each other";
  if (said.compare && said.distance.empty()) return "--compare needs --distance";
  if (!said.distance.empty() && !said.compare && !is_sought(said))
    return "--distance needs --compare, --time or --fastest";
  if (said.resonance_hz && !said.compare) return "--resonance needs --compare";
  if (said.damping && !said.resonance_hz) return "--damping needs --resonance";
  if (!said.tolerance.empty() && !said.resonance_hz) return "--tolerance needs --resonance";
  if (said.axis.empty() == !said.offline.is_meant()) return "name an axis, or say --model MODEL";
  if (auto conflict = conflict_of_search(said); !conflict.empty()) return conflict;
  return objection_to(said.offline);
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

With --model instead of AXIS it computes the same of an axis that need not be there: a module as it is
when it starts, with the screw or what else it drives. It shows the registers of the chip beside the
parameters, and how far what they give is off the wish. --as prints them for other programs: sap and tmc
are lines and a program that 'tmclctl program' assembles, c is a table of the chip's registers at 16 MHz.

  tmclctl ramp --model TMCM-142 --screw-pitch 5 --velocity 20mm/s --acceleration 500mm/s^2 --jerk max
  tmclctl ramp --model TMCM-142 --velocity 20rps --acceleration 50rps/s --as sap --motor 0
  tmclctl ramp --model TMCM-6212 --units-per-revolution 360 --unit deg --velocity 90deg/s --acceleration 2rps/s

--compare sets nothing: it shows what all bows of a TMC457 or a TMC4361, or sets of A1, V1 and D1 on a
sixPoint chip, make of a move: its time and its longest phase. With --resonance a load swings behind
the motor; then it shows how far that still swings when the motor has arrived, when it swings by no
more than --tolerance, and with which ramp that is first.

  tmclctl ramp --model TMCM-142 --screw-pitch 5 --velocity 20mm/s --acceleration 200mm/s^2 --compare --distance 10mm --resonance 12Hz --tolerance 0.01mm

--time and --fastest find the velocity and the acceleration, and set nothing. --time: the least
acceleration with which a move by --distance takes no longer, and the least velocity with that. --fastest:
the ramp with which it takes the shortest time, and asks at each speed for no more torque than the motor
has by --load, --friction, --inertia and --corner-speed; --margin of what is asked is left. The figures are those
of a motor under load in the simulator, in 1/1000 of the torque that the motor holds, for full steps
and seconds. Both let the ramp generator make the move, to the tick; no velocity is above --velocity.

  tmclctl ramp x --time 1s --distance 10mm
  tmclctl ramp --model TMCM-6212 --screw-pitch 5 --time 800ms --distance 20mm --as tmc
  tmclctl ramp --model TMCM-6212 --screw-pitch 5 --fastest --distance 20mm --inertia 20000 --friction 50 --corner-speed 600 --margin 30%
)";

void add_search(VerbForm<verb::Ramp>& ramp) {
  constexpr double greatest_figure = 1e9;
  auto& typed = *ramp.operator->();
  ramp.option("--time", "TIME", "Find the gentlest ramp with which the move takes no longer",
              [&typed](const std::string& text) { return read_move_time(text, typed.time_s); });
  ramp.flag("--fastest", "Find the quickest ramp for which the motor has the torque",
            ramp->fastest);
  ramp.option("--load", "TORQUE", "What the motor drives, in 1/1000 of the torque that it holds",
              number(ramp->torque.load, 0, greatest_figure));
  ramp.option("--friction", "TORQUE",
              "More of it for each full step a second, in 1/1000: load_per_velocity",
              number(ramp->torque.load_per_velocity, 0, greatest_figure));
  ramp.option("--inertia", "TORQUE", "More of it for each full step a second squared, in 1/1000000",
              number(ramp->torque.inertia, 0, greatest_figure));
  ramp.option("--corner-speed", "SPEED",
              "Full steps a second above which the torque of the motor falls",
              number(ramp->torque.corner_speed, 1, greatest_figure));
  ramp.option("--margin", "PART", "Torque to leave, of what is asked (default 30%)",
              [&typed](const std::string& text) { return read_margin(text, typed.margin); });
}

}  // namespace

void add_ramp(Grammar& grammar) {
  auto ramp = grammar.verb<verb::Ramp>(
      "ramp", access::acts, "Choose and set registers for a velocity and an acceleration",
      ramp_help, run);
  ramp.optional_word("AXIS", axis_meaning, text(ramp->axis));
  add_offline_axis(ramp, ramp->offline);
  ramp.option("--velocity", "VELOCITY",
              "Of positioning moves, such as 50000pps; with --time and --fastest no more than this",
              text(ramp->velocity));
  ramp.option("--acceleration", "ACCELERATION", "Of every ramp, such as 100mm/s^2",
              text(ramp->acceleration));
  ramp.option("--deceleration", "ACCELERATION", "To brake with, where the module has it apart",
              text(ramp->deceleration));
  ramp.option("--jerk", "JERK",
              "How fast the acceleration changes, such as 500mm/s^3, or max; as it is without",
              text(ramp->jerk));
  auto& typed = *ramp.operator->();
  ramp.option("--as", "FORM", "With --model: print it for other programs: sap, tmc, c or json",
              [&typed](const std::string& text) { return read_form(text, typed.as); });
  ramp.option("--motor", "N", "With --as sap and tmc: of the module (default 0)",
              number(ramp->motor, 0, 255));
  ramp.flag("--compare", "Show all bows, or sets of A1, V1 and D1, for a move; nothing is set",
            ramp->compare);
  ramp.option("--distance", "DISTANCE",
              "With --compare, --time and --fastest: of the move, such as 10mm",
              text(ramp->distance));
  add_search(ramp);
  ramp.option("--resonance", "HZ", "With --compare: follow a load that swings so behind the motor",
              resonance(typed.resonance_hz));
  ramp.option("--damping", "D", "Of its swings: 0 to less than 1 (default 0.05)",
              number(ramp->damping, 0, 0.999));
  ramp.option("--tolerance", "DISTANCE",
              "Within which the load is to stand (default: a thousandth of the move)",
              text(ramp->tolerance));
  ramp.flag("--dry-run", "Only show what would be set", ramp->dry_run);
  ramp.flag("--store", "Keep it in the module's EEPROM, too", ramp->store);
  ramp.internal(ramp->internal);
  ramp.alone([](const verb::Ramp& said) { return said.offline.is_meant(); }, run_on_model);
  ramp.object(conflict_in);
}

}  // namespace tmclctl

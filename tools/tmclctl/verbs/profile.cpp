// profile simulate.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "output/output_file.hpp"
#include "output/print.hpp"
#include "plot/recording.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"
#include "profile/setup.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using profile::Motion;
using profile::Outcome;
using profile::Setup;
using profile::Simulation;
using profile::Tick;

// So many points make a curve that looks smooth.
constexpr Tick curve_points = 1000;
constexpr double most_csv_rows = 1e6;

void warn_of(const Outcome& outcome, const Setup& setup, const verb::Simulate& verb,
             Output& output) {
  warn(outcome.warnings, output);
  for (const auto& change : verb.changes) {
    if (verb.until && change.time > *verb.until)
      warn(fmt::format("--change {}:{} comes after --until {}", change.time, change.setting,
                       *verb.until),
           output);
  }
  if (outcome.cut_off)
    warn(fmt::format("it changes again and again; followed to {} {} only",
                     tmcl::plain_number(setup.time_of(outcome.end), 6), setup.generator.time_unit),
         output);
  if (outcome.more_phases)
    warn(fmt::format("only the first {} phases are listed", profile::most_phases), output);
}

Result<json::array> samples_of(const verb::Simulate& verb, const Setup& setup,
                               const Simulation& simulation) {
  std::vector<std::size_t> by_time(verb.samples.size());
  std::iota(by_time.begin(), by_time.end(), std::size_t{0});
  std::ranges::stable_sort(by_time, {}, [&](std::size_t i) { return verb.samples[i]; });
  std::vector<Tick> ticks;
  for (const auto i : by_time) ticks.push_back(setup.tick_at(verb.samples[i]));
  const auto motions = simulation.motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  json::array samples(verb.samples.size());
  for (std::size_t k = 0; k < by_time.size(); ++k) {
    const auto& motion = (*motions)[k];
    samples[by_time[k]] = json::object{{"t", verb.samples[by_time[k]]},
                                       {"x", motion.position},
                                       {"v", motion.velocity},
                                       {"a", motion.acceleration}};
  }
  return samples;
}

/// What registers were given that count in parts of a unit.
struct Given {
  std::string_view name;
  std::int64_t value;
  const profile::Scale* scale;
};

std::vector<Given> scaled_registers(const Setup& setup) {
  std::vector<Given> given;
  for (const auto& write : setup.script.start) {
    const auto name = setup.generator.registers[write.index].name;
    if (const auto* scale = setup.generator.scale_of(name))
      given.push_back({name, write.value, scale});
  }
  return given;
}

json::object registers_json(const Setup& setup) {
  json::object registers;
  for (const auto& [name, value, scale] : scaled_registers(setup)) {
    registers[name] = json::object{{"value", value},
                                   {"hex", fmt::format("{:x}", value)},
                                   {"in_unit", scale->in_unit(value)},
                                   {"unit", scale->unit}};
  }
  return registers;
}

/// Of a module: parameters and registers beside each other.
json::array parameters_json(const std::vector<profile::GivenParameter>& parameters) {
  json::array all;
  for (const auto& one : parameters) {
    all.push_back(json::object{{"parameter", one.name},
                               {"number", one.number},
                               {"value", one.value},
                               {"said", one.said},
                               {"register", one.chip_register},
                               {"holds", one.held},
                               {"deviation", one.off ? json::value(*one.off) : json::value()}});
  }
  return all;
}
void print_parameters(const std::vector<profile::GivenParameter>& parameters, std::ostream& out) {
  Table table({"PARAMETER", "NUMBER", "SAID", "VALUE", "REGISTER", "HOLDS", "OFF"});
  for (const auto& one : parameters) {
    const bool has_register = !one.chip_register.empty();
    table.add({one.name, std::to_string(one.number), one.said, std::to_string(one.value),
               has_register ? one.chip_register : "-",
               has_register ? std::to_string(one.held) : "-",
               one.off ? fmt::format("{:+.3f} %", *one.off * 100) : "-"});
  }
  table.print(out);
}

/// From one place to another.
struct Ramp {
  double duration;
  std::int64_t length;
};
Ramp ramp_between(const profile::Place& from, const profile::Place& to, const Setup& setup) {
  return {setup.time_of(to.tick) - setup.time_of(from.tick), std::abs(to.position - from.position)};
}
Ramp ramp_up(const Outcome& outcome, const Setup& setup) {
  return ramp_between(outcome.start, outcome.first_peak, setup);
}
/// Nothing where it does not come to rest on its target.
std::optional<Ramp> ramp_down(const Outcome& outcome, const Setup& setup) {
  if (!outcome.arrival) return std::nullopt;
  return ramp_between(outcome.last_peak, {*outcome.arrival, outcome.at_end.position}, setup);
}
/// A time, as a field called so. In seconds, but for a generator that counts in cycles: what is in
/// the field of seconds is cycles then, too, for those who know no other.
void add_time(json::object& object, std::string_view what, const json::value& time,
              const Setup& setup) {
  object[fmt::format("{}_s", what)] = time;
  if (!setup.generator.clocked)
    object[fmt::format("{}_{}", what, setup.generator.time_unit)] = time;
}
json::value to_json(const std::optional<Ramp>& ramp, const Setup& setup) {
  if (!ramp) return nullptr;
  json::object object;
  add_time(object, "duration", ramp->duration, setup);
  object["microsteps"] = ramp->length;
  return object;
}

json::object to_json(const Outcome& outcome, const Setup& setup, json::array samples) {
  json::array phases;
  for (const auto& phase : outcome.phases) {
    json::object object{{"name", phase.name}};
    add_time(object, "start", setup.time_of(phase.tick), setup);
    phases.push_back(std::move(object));
  }
  json::object document{{"generator", setup.generator.name}};
  add_time(document, "duration",
           outcome.arrival ? json::value(setup.time_of(*outcome.arrival)) : json::value(nullptr),
           setup);
  document["final_position"] = outcome.at_end.position;
  document["peak_velocity"] = outcome.peak_velocity;
  document["ramp_up"] = to_json(std::optional(ramp_up(outcome, setup)), setup);
  document["ramp_down"] = to_json(ramp_down(outcome, setup), setup);
  document["phases"] = std::move(phases);
  document["samples"] = std::move(samples);
  if (!setup.generator.scales.empty()) document["registers"] = registers_json(setup);
  if (!setup.parameters.empty()) document["parameters"] = parameters_json(setup.parameters);
  return document;
}

/// Every `step` from 0 on: until the end, or to the first at which what there was to see is over.
Result<std::vector<double>> csv_times(const verb::Simulate& verb, const Setup& setup,
                                      const Outcome& outcome) {
  constexpr double rounding = 1e-9;
  const double steps = setup.time_of(outcome.end) / *verb.csv_step;
  const bool to_the_first_after = !verb.until && !outcome.cut_off;
  const double rows =
      1 + (to_the_first_after ? std::ceil(steps - rounding) : std::floor(steps + rounding));
  if (!(rows <= most_csv_rows)) {
    return tl::unexpected(usage_error(
        "too_many_rows",
        fmt::format("--csv {} makes {:.0f} rows in {} {}; {:.0f} at most", *verb.csv_step, rows,
                    setup.time_of(outcome.end), setup.generator.time_unit, most_csv_rows)));
  }
  std::vector<double> times(static_cast<std::size_t>(rows));
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i) * *verb.csv_step;
  return times;
}

Result<std::string> to_csv(const verb::Simulate& verb, const Setup& setup,
                           const Simulation& simulation, const Outcome& outcome) {
  const auto times = csv_times(verb, setup, outcome);
  if (!times) return tl::unexpected(times.error());
  std::vector<Tick> ticks;
  for (const double time : *times) ticks.push_back(setup.tick_at(time));
  const auto motions = simulation.motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  std::string text = "t,x,v,a\n";
  for (std::size_t i = 0; i < times->size(); ++i) {
    const auto& motion = (*motions)[i];
    text += fmt::format("{},{},{},{}\n", tmcl::plain_number((*times)[i], 12), motion.position,
                        motion.velocity, motion.acceleration);
  }
  return text;
}

/// Evenly spread, and where a phase begins, so that corners are corners.
std::vector<Tick> curve_ticks(const Outcome& outcome) {
  std::vector<Tick> ticks;
  for (Tick i = 0; i <= curve_points; ++i)
    ticks.push_back(outcome.end / curve_points * i + outcome.end % curve_points * i / curve_points);
  for (const auto& phase : outcome.phases) ticks.push_back(phase.tick);
  std::ranges::sort(ticks);
  const auto [first, last] = std::ranges::unique(ticks);
  ticks.erase(first, last);
  return ticks;
}

Result<plot::Recording> record(const Setup& setup, const Simulation& simulation,
                               const Outcome& outcome) {
  const auto ticks = curve_ticks(outcome);
  const auto motions = simulation.motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  plot::Recording recording{std::string(setup.generator.name),
                            {},
                            std::string(setup.generator.time_unit),
                            std::string(setup.generator.length_unit)};
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    recording.samples.push_back(
        {setup.time_of(ticks[i]), (*motions)[i].position, (*motions)[i].velocity});
  }
  return recording;
}

Result<void> draw(const plot::Recording& recording, const std::string& svg_path, Output& output) {
  if (svg_path.empty()) {
    output.out << plot::to_text(recording, output.out_screen);
    return {};
  }
  OutputFile svg;
  return svg.open(svg_path).and_then([&] { return svg.write(plot::to_svg(recording)); });
}

void print_ramps(const Outcome& outcome, const Setup& setup, std::ostream& out) {
  const auto text = [&](const Ramp& ramp) {
    return fmt::format("{} {} and {} {}", tmcl::plain_number(ramp.duration, 4),
                       setup.generator.time_unit, ramp.length, setup.generator.length_unit);
  };
  out << "up to speed in " << text(ramp_up(outcome, setup));
  if (const auto down = ramp_down(outcome, setup)) out << ", and down to rest in " << text(*down);
  out << '\n';
}

Result<void> show(const verb::Simulate& verb, const Setup& setup, const Simulation& simulation,
                  const Outcome& outcome, Output& output) {
  if (output.json) {
    return samples_of(verb, setup, simulation).map([&](json::array samples) {
      print_json(to_json(outcome, setup, std::move(samples)), output);
    });
  }
  if (verb.csv_step) {
    return to_csv(verb, setup, simulation, outcome).map([&](const std::string& text) {
      output.out << text;
    });
  }
  for (const auto& [name, value, scale] : scaled_registers(setup)) {
    output.out << fmt::format("{:<12} {} {} = {} ({:x}h)\n", name,
                              tmcl::plain_number(scale->in_unit(value), 10), scale->unit, value,
                              value);
  }
  if (!setup.parameters.empty()) print_parameters(setup.parameters, output.out);
  if (verb.svg.empty()) print_ramps(outcome, setup, output.out);
  return record(setup, simulation, outcome).and_then([&](const plot::Recording& recording) {
    return draw(recording, verb.svg, output);
  });
}

Result<ExitCode> run(const verb::Simulate& verb, Output& output) {
  const auto setup =
      verb.axis.is_meant() ? profile::read_model_setup(verb) : profile::read_setup(verb);
  if (!setup) return tl::unexpected(setup.error());
  const auto simulation = setup->generator.simulate(setup->script);
  const auto until =
      verb.until ? std::optional(setup->tick_at(*verb.until)) : std::optional<Tick>{};
  const auto outcome = simulation->follow(until);
  if (!outcome) return tl::unexpected(outcome.error());
  warn_of(*outcome, *setup, verb, output);
  return show(verb, *setup, *simulation, *outcome, output).map([] { return ExitCode::done; });
}

constexpr double longest_simulated_time = 1e9;
constexpr double shortest_csv_step = 1e-9;

Reading read_times(std::string_view list, std::vector<double>& times) {
  times.clear();
  for (std::size_t begin = 0; begin <= list.size();) {
    const auto comma = std::min(list.find(',', begin), list.size());
    const auto time =
        parse_number<double>(list.substr(begin, comma - begin), 0, longest_simulated_time);
    if (!time) return tl::unexpected(time.error());
    times.push_back(*time);
    begin = comma + 1;
  }
  return {};
}

Reading read_change(const std::string& text, std::vector<verb::Simulate::Change>& changes) {
  const auto colon = text.find(':');
  if (colon == std::string::npos)
    return tl::unexpected(fmt::format("'{}' is no SECONDS:REGISTER=VALUE", text));
  return parse_number<double>(std::string_view(text).substr(0, colon), 0, longest_simulated_time)
      .map([&](double time) {
        changes.push_back({time, text.substr(colon + 1)});
      });
}

std::string generator_names() {
  std::vector<std::string_view> names;
  for (const auto& generator : profile::generators()) names.push_back(generator.name);
  return fmt::format("One of {}", fmt::join(names, ", "));
}

std::string conflict_in(const verb::Simulate& said, bool json) {
  const int forms = (json ? 1 : 0) + (said.csv_step ? 1 : 0) + (said.svg.empty() ? 0 : 1);
  if (forms > 1) return "--json, --csv and --svg exclude each other";
  if (said.generator.empty() == !said.axis.is_meant()) return "give --generator or --model";
  if (auto objection = objection_to(said.axis); !objection.empty()) return objection;
  return !said.samples.empty() && !json ? "--sample needs --json" : "";
}

constexpr const char* profile_help = R"(
Nothing is sent anywhere: no bus, no tmcld, no module is needed.

  tmclctl profile simulate --help      registers of a chip: how it moves
  tmclctl profile solve --help         some values of a trapezoid: all of them
)";

constexpr const char* simulate_help = R"(
Computes, exactly to the tick (tmc4361: by a model), how a chip's ramp generator moves: from rest at
position 0 and tick 0 until it stands on its target, or until --until. Draws position and velocity;
--csv, --svg and --json say it in other ways. x is in microsteps, v and a are in the chip's units.

  tmclctl profile simulate --generator tmc429 v_max=1000 a_max=500 pulse_div=2 ramp_div=3 \
      x_target=100000
  tmclctl --json profile simulate --generator sixpoint amax=3000 vmax=268000 dmax=3000 \
      d1=3000 xtarget=512000 --sample 0.5,1
  tmclctl profile simulate --generator tmc457 v_max=5000000 a_max=24624 d_max=24624 bow_max=11 \
      x_target=50000 --csv 0.01
  tmclctl profile simulate --generator tmc4361 vmax=25600000 amax=800000 dmax=400000 \
      bow1=1000000 bow2=2000000 bow3=500000 bow4=400000 xtarget=300000
  tmclctl profile simulate --generator mc1451a profile=s_curve velocity=180224 acceleration=66 \
      jerk=42950 position=100000 --svg s_curve.svg
  tmclctl profile simulate --generator tmc429 mode=velocity v_max=2047 a_max=100 pulse_div=3 \
      ramp_div=5 v_target=500 --change 0.5:v_target=-500 --until 2

Registers are called as in the data sheets; values are decimal, 0x..., or these names:
  tmc429    mode=ramp|soft|velocity|hold v_min v_max v_target v_actual a_max pulse_div ramp_div
            x_target x_actual; pmul and pdiv follow from a_max and the dividers if not given;
            v_min is 1 if not given, as the modules' firmware writes it. What no data sheet tells:
            last_step=r3|r1|r2
            factor_rule=percent_99|percent_95|percent_98_8|nearest|nearest_less_one
            order=ramp_first|pulse_first accumulator=cleared|kept
  tmc457    mode=position|velocity|hold v_max v_target a_max d_max a_max_d_max d_stop bow_max
            x_target; a_max_d_max is both a_max and d_max, and of it and those the later counts
  tmc4361   rampmode=position|velocity vmax amax dmax bow1 bow2 bow3 bow4 xtarget, S-shaped ramps
            only: a model, not exact to the tick; clk_freq is to be f_clk if that is given
  sixpoint  (TMC5130, TMC5160, TMC5072) rampmode=position|velocity_positive|velocity_negative|hold
            vstart a1 v1 amax vmax dmax d1 vstop tzerowait xtarget; vstop is vstart, and at least
            10, if not given
  mc1451a   profile=s_curve|trapezoidal position velocity acceleration jerk; steps and cycles.
            With a point, velocity=2.75 is in steps/cycle, and so on; both forms are shown
With --model instead of --generator they are the parameters of a module that need not be there, by name
or number and in any unit, as 'tmclctl set' takes them; the others are as the module starts. What is
typed is shown beside its parameter and its register, and by how much the register is off it.
target_position moves, target_velocity turns; modules of all families but those whose firmware makes
the ramps.

  tmclctl profile simulate --model TMCM-142 --screw-pitch 5 max_velocity=20mm/s x_target=150mm
  tmclctl profile simulate --model TMCM-6212 4=51200 5=2rps/s target_velocity=60rpm --until 2

f_clk=HZ is the chip's clock (100 kHz to 100 MHz; 16 MHz if not given); mc1451a counts times in
cycles wherever SECONDS are meant. Mode and target are written last, whatever the order here.

A change acts after everything up to its instant; changes of one instant act in the order given.
--json prints {"generator", "duration_s", "final_position", "peak_velocity", "ramp_up": {"duration_s",
"microsteps"}, "ramp_down": the same, "phases": [{"name", "start_s"}], "samples": [{"t", "x", "v",
"a"}]}; duration_s is when it last came to rest on its target, null if it does not. Those of mc1451a
are cycles: duration_cycles and start_cycles have them as well, and are to be preferred. The ramps are
what comes before it is first as fast as it gets, and after that, until it stands there; text says so,
too.
What the chip would take but should not be told is a warning on standard error, the same that
'tmclctl set' gives on a module.
)";

}  // namespace

Form add_profile(Grammar& grammar) {
  const auto profile =
      grammar.group("profile", "Compute movements, without any module", profile_help);
  auto simulate = grammar.verb<verb::Simulate>(
      profile, "simulate", access::offline("it computes, and asks no module"),
      "What a chip's ramp generator makes of registers", simulate_help, run);
  simulate.option("--generator", "NAME", generator_names(), text(simulate->generator));
  add_offline_axis(simulate, simulate->axis);
  auto& said = *simulate.operator->();
  simulate.words("REGISTER=VALUE",
                 "What is written before it starts, with --model parameters; the others stay as at "
                 "power-up",
                 texts(said.settings));
  simulate.repeated_option(
      "--change", "SECONDS:REGISTER=VALUE",
      "Write a register at this time; may be given many times",
      [&said](const std::string& text) { return read_change(text, said.changes); });
  simulate.repeated_option(
      "--sample", "SECONDS,...", "With --json: the motion at these times",
      [&said](const std::string& text) { return read_times(text, said.samples); });
  simulate.option("--until", "SECONDS", "End then, and not when it stands on its target",
                  number(simulate->until, 0.0, longest_simulated_time));
  simulate.option("--csv", "SECONDS", "Print t,x,v,a every so often instead of drawing",
                  number(simulate->csv_step, shortest_csv_step, longest_simulated_time));
  simulate.option("--svg", "FILE", "Draw into this file, not on the screen",
                  svg_file(simulate->svg));
  simulate.object(conflict_in);
  return profile;
}

}  // namespace tmclctl

// profile simulate.
#include <algorithm>

#include <fmt/format.h>

#include "output/output_file.hpp"
#include "output/print.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"
#include "profile/drawing.hpp"
#include "profile/report.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
using profile::Profile;

Result<void> draw(const plot::Picture& picture, const std::string& svg_path, Output& output) {
  if (svg_path.empty()) {
    output.out << plot::to_text(picture, output.out_screen);
    return {};
  }
  OutputFile svg;
  return svg.open(svg_path).and_then([&] { return svg.write(plot::to_svg(picture)); });
}

void warn_of(const Profile& profile, const verb::Simulate& verb, Output& output) {
  const auto& [label, setup, simulation, outcome, recording, load] = profile;
  const auto of = label.empty() ? "" : fmt::format("with {}: ", label);
  for (const auto& warning : outcome.warnings) warn(of + warning, output);
  if (outcome.cut_off)
    warn(of + fmt::format("it changes again and again; followed to {} {} only",
                          tmcl::plain_number(setup.time_of(outcome.end), 6),
                          setup.generator.time_unit),
         output);
  if (outcome.more_phases)
    warn(of + fmt::format("only the first {} phases are listed", profile::most_phases), output);
  if (!label.empty()) return;
  for (const auto& change : verb.changes) {
    if (verb.until && change.time > *verb.until)
      warn(fmt::format("--change {}:{} comes after --until {}", change.time, change.setting,
                       *verb.until),
           output);
  }
}

Result<void> print(const verb::Simulate& verb, const std::vector<Profile>& profiles,
                   Output& output) {
  const auto& first = profiles.front();
  if (output.json) {
    auto samples = profile::samples_of(first, verb.samples);
    if (!samples) return tl::unexpected(samples.error());
    auto document = to_json(first, std::move(*samples));
    json::array others;
    for (std::size_t i = 1; i < profiles.size(); ++i) {
      auto other = profile::samples_of(profiles[i], verb.samples);
      if (!other) return tl::unexpected(other.error());
      others.push_back(to_json(profiles[i], std::move(*other)));
    }
    if (!verb.with.empty()) document["with"] = std::move(others);
    print_json(document, output);
    return {};
  }
  if (verb.csv_step)
    return to_csv(first, {*verb.csv_step, verb.show, verb.until.has_value()})
        .map([&](const std::string& text) { output.out << text; });
  print_registers(first, output.out);
  if (!verb.with.empty() || verb.resonance_hz) {
    print_comparison(profiles, output.out);
  } else if (verb.svg.empty()) {
    print_ramps(first, output.out);
  }
  return draw(picture_of(profiles, verb.show), verb.svg, output);
}

/// With the settings of `with` in place of those of the same name.
verb::Simulate changed(verb::Simulate verb, const std::string& with) {
  for (std::size_t begin = 0; begin <= with.size();) {
    const auto comma = std::min(with.find(',', begin), with.size());
    const auto setting = with.substr(begin, comma - begin);
    const auto name = setting.substr(0, setting.find('=')) + "=";
    std::erase_if(verb.settings, [&](const std::string& other) { return other.starts_with(name); });
    verb.settings.push_back(setting);
    begin = comma + 1;
  }
  return verb;
}

/// `draws`: it is to be recorded.
Result<Profile> follow(const verb::Simulate& verb, std::string label, bool draws) {
  auto setup = verb.axis.is_meant() ? profile::read_model_setup(verb) : profile::read_setup(verb);
  if (!setup) return tl::unexpected(setup.error());
  auto simulation = setup->generator.simulate(setup->script);
  const auto until =
      verb.until ? std::optional(setup->tick_at(*verb.until)) : std::optional<profile::Tick>{};
  auto outcome = simulation->follow(until);
  if (!outcome) return tl::unexpected(outcome.error());
  Profile followed{std::move(label), std::move(*setup), std::move(simulation), std::move(*outcome)};
  if (!draws && !verb.resonance_hz) return followed;
  auto recording = record(followed, verb.until.has_value());
  if (!recording) return tl::unexpected(recording.error());
  followed.recording = std::move(*recording);
  if (!verb.resonance_hz) return followed;
  followed.load = profile::follow_load(followed.recording,
                                       {{*verb.resonance_hz, verb.damping}, verb.tolerance});
  // A motor that goes on shakes its load for ever.
  if (goes_on(followed)) followed.load->settled.reset();
  return followed;
}

Result<ExitCode> run(const verb::Simulate& verb, Output& output) {
  std::vector<Profile> profiles;
  const auto add = [&](const verb::Simulate& one, const std::string& label) -> Result<void> {
    auto followed = follow(one, label, !output.json && !verb.csv_step);
    if (!followed) return tl::unexpected(followed.error());
    warn_of(*followed, verb, output);
    profiles.push_back(std::move(*followed));
    return {};
  };
  if (auto added = add(verb, ""); !added) return tl::unexpected(added.error());
  for (const auto& with : verb.with)
    if (auto added = add(changed(verb, with), with); !added) return tl::unexpected(added.error());
  return print(verb, profiles, output).map([] { return ExitCode::done; });
}

constexpr double longest_simulated_time = 1e9;
constexpr double shortest_csv_step = 1e-9;
constexpr std::size_t most_profiles = 20;

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
  if (said.resonance_hz && said.generator == "mc1451a")
    return "--resonance is in seconds, and mc1451a counts in cycles";
  if (said.tolerance && !said.resonance_hz) return "--tolerance needs --resonance";
  if (said.csv_step && !said.with.empty()) return "--csv and --with exclude each other";
  return !said.samples.empty() && !json ? "--sample needs --json" : "";
}

constexpr const char* profile_help = R"(
Nothing is sent anywhere: no bus, no tmcld, no module is needed.

  tmclctl profile simulate --help      registers of a chip: how it moves
  tmclctl profile solve --help         some values of a trapezoid: all of them
)";

constexpr const char* simulate_help = R"(
Computes, exactly to the tick (tmc4361: by a model), how a chip's ramp generator moves: from rest at
position 0 and tick 0 until it stands on its target, or until --until. Draws position and velocity, or
what --show names, with its phases; --csv, --svg and --json say it in other ways. x is in microsteps, v
and a are in the chip's units, and with --model drawn in the unit of the axis. Where the acceleration
jumps there is no jerk to draw. Of a motor that swings around its target the first 40 phases are drawn.
--with compares: times, peaks and ways in a table, and the first four in one picture with the profile
that is given. --resonance follows a load that swings behind the motor: a dotted line, how far it
still swings when the motor has arrived, when it swings by no more than --tolerance, and with
which profile that is first.

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
  tmclctl profile simulate --model TMCM-142 --screw-pitch 5 max_velocity=20mm/s x_target=10mm \
      max_bow=8 --resonance 12 --damping 0.05 --tolerance 0.01
  tmclctl profile simulate --generator tmc457 v_max=5000000 a_max=24624 d_max=24624 bow_max=11 \
      x_target=50000 --with bow_max=0 --with bow_max=14 --show v,a,j --svg bows.svg

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
"a"}]}, with --with {"with": [the same of each, and its "settings"]}, and with --resonance {"load":
{"swing", "unit", "settled_s"}}, null if it never stands; duration_s is when it last came to rest on its target, null if it does not. Those of mc1451a
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
  plot::add_show(simulate, simulate->show);
  simulate.repeated_option(
      "--with", "REGISTER=VALUE,...",
      fmt::format("Show beside it what these make of it; {} times at most", most_profiles),
      [&said](const std::string& text) -> Reading {
        if (said.with.size() == most_profiles)
          return tl::unexpected(std::string("too many profiles"));
        said.with.push_back(text);
        return {};
      });
  simulate.option("--resonance", "HZ", "Follow a load that swings so behind the motor",
                  resonance(simulate->resonance_hz));
  simulate.option("--damping", "D", "Of its swings: 0 to less than 1 (default 0.05)",
                  number(simulate->damping, 0, 0.999));
  simulate.option("--tolerance", "UNITS",
                  "Within which it is to stand, as drawn (default: a thousandth of the way)",
                  number(simulate->tolerance, 0, 1e12));
  simulate.option("--csv", "SECONDS",
                  "Print t,x,v,a, or what --show names, every so often instead of drawing",
                  number(simulate->csv_step, shortest_csv_step, longest_simulated_time));
  simulate.option("--svg", "FILE", "Draw into this file, not on the screen",
                  svg_file(simulate->svg));
  simulate.object(conflict_in);
  return profile;
}

}  // namespace tmclctl

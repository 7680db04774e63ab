// profile simulate.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "output_file.hpp"
#include "plot/recording.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"
#include "print.hpp"
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
json::value to_json(const std::optional<Ramp>& ramp) {
  if (!ramp) return nullptr;
  return json::object{{"duration_s", ramp->duration}, {"microsteps", ramp->length}};
}

json::object to_json(const Outcome& outcome, const Setup& setup, json::array samples) {
  json::array phases;
  for (const auto& phase : outcome.phases)
    phases.push_back(json::object{{"name", phase.name}, {"start_s", setup.time_of(phase.tick)}});
  json::object document{
      {"generator", setup.generator.name},
      {"duration_s",
       outcome.arrival ? json::value(setup.time_of(*outcome.arrival)) : json::value(nullptr)},
      {"final_position", outcome.at_end.position},
      {"peak_velocity", outcome.peak_velocity},
      {"ramp_up", to_json(std::optional(ramp_up(outcome, setup)))},
      {"ramp_down", to_json(ramp_down(outcome, setup))},
      {"phases", std::move(phases)},
      {"samples", std::move(samples)}};
  if (!setup.generator.scales.empty()) document["registers"] = registers_json(setup);
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
  if (verb.svg.empty()) print_ramps(outcome, setup, output.out);
  return record(setup, simulation, outcome).and_then([&](const plot::Recording& recording) {
    return draw(recording, verb.svg, output);
  });
}

}  // namespace

Result<ExitCode> run(const verb::Simulate& verb, Output& output) {
  const auto setup = profile::read_setup(verb);
  if (!setup) return tl::unexpected(setup.error());
  const auto simulation = setup->generator.simulate(setup->script);
  const auto until =
      verb.until ? std::optional(setup->tick_at(*verb.until)) : std::optional<Tick>{};
  const auto outcome = simulation->follow(until);
  if (!outcome) return tl::unexpected(outcome.error());
  warn_of(*outcome, *setup, verb, output);
  return show(verb, *setup, *simulation, *outcome, output).map([] { return ExitCode::done; });
}

}  // namespace tmclctl

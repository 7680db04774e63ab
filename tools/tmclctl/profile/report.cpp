#include "profile/report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "output/print.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl::profile {
namespace {

namespace json = boost::json;

/// What registers were given that count in parts of a unit.
struct Given {
  std::string_view name;
  std::int64_t value;
  const Scale* scale;
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
json::array parameters_json(const std::vector<GivenParameter>& parameters) {
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
void print_parameters(const std::vector<GivenParameter>& parameters, std::ostream& out) {
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
Ramp ramp_between(const Place& from, const Place& to, const Setup& setup) {
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
json::value ramp_json(const std::optional<Ramp>& ramp, const Setup& setup) {
  if (!ramp) return nullptr;
  json::object object;
  add_time(object, "duration", ramp->duration, setup);
  object["microsteps"] = ramp->length;
  return object;
}

json::array phases_json(const Profile& profile) {
  json::array phases;
  for (const auto& phase : profile.outcome.phases) {
    json::object object{{"name", phase.name}};
    add_time(object, "start", profile.setup.time_of(phase.tick), profile.setup);
    phases.push_back(std::move(object));
  }
  return phases;
}

/// Every step from 0 on: until the end, or to the first at which what there was to see is over.
Result<std::vector<double>> times_of(const Rows& rows, const Profile& profile) {
  constexpr double rounding = 1e-9;
  const auto& [label, setup, simulation, outcome, recording, load] = profile;
  const double steps = setup.time_of(outcome.end) / rows.step;
  const bool to_the_first_after = !rows.to_the_end && !outcome.cut_off;
  const double count =
      1 + (to_the_first_after ? std::ceil(steps - rounding) : std::floor(steps + rounding));
  if (!(count <= plot::most_csv_rows)) {
    return tl::unexpected(usage_error(
        "too_many_rows",
        fmt::format("--csv {} makes {:.0f} rows in {} {}; {:.0f} at most", rows.step, count,
                    setup.time_of(outcome.end), setup.generator.time_unit, plot::most_csv_rows)));
  }
  std::vector<double> times(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i) * rows.step;
  return times;
}

/// The jerk as it is drawn, in what the chip counts in.
class Jerks {
 public:
  static Result<Jerks> of(const Profile& profile) {
    auto recording = record(profile, true);
    if (!recording) return tl::unexpected(recording.error());
    recording->user.reset();
    return Jerks(plot::jerk_curve(*recording));
  }
  double at(double time) const {
    const auto next = std::ranges::upper_bound(curve_.times, time) - curve_.times.begin();
    return curve_.values[static_cast<std::size_t>(std::max<std::ptrdiff_t>(next, 1) - 1)];
  }

 private:
  explicit Jerks(plot::Curve curve) : curve_(std::move(curve)) {}
  plot::Curve curve_;
};

std::string cell(plot::Quantity quantity, const Motion& motion, double time,
                 const std::optional<Jerks>& jerks) {
  switch (quantity) {
    case plot::Quantity::position: return std::to_string(motion.position);
    case plot::Quantity::velocity: return std::to_string(motion.velocity);
    case plot::Quantity::acceleration: return std::to_string(motion.acceleration);
    case plot::Quantity::jerk: break;
  }
  return tmcl::plain_number(jerks->at(time), 6);
}

/// Of one profile among others.
std::vector<std::string> row_of(const Profile& profile) {
  const auto& [label, setup, simulation, outcome, recording, load] = profile;
  const auto number = [](double value) { return tmcl::plain_number(value, 5); };
  const auto way = [&, &recording = recording](std::int64_t microsteps) {
    return number(std::abs(plot::shown_position(static_cast<double>(microsteps), recording)));
  };
  const auto up = ramp_up(outcome, setup);
  const auto down = ramp_down(outcome, setup);
  const auto peak = plot::shown_velocity(static_cast<double>(outcome.peak_velocity), recording);
  std::vector<std::string> cells{label.empty() ? "as given" : label,
                                 outcome.arrival ? number(setup.time_of(*outcome.arrival)) : "-",
                                 number(std::abs(peak)),
                                 number(up.duration),
                                 way(up.length),
                                 down ? number(down->duration) : "-",
                                 down ? way(down->length) : "-"};
  if (!load) return cells;
  cells.push_back(number(load->swing));
  cells.push_back(load->settled ? number(*load->settled) : "never");
  return cells;
}

std::vector<std::string> headings_of(const plot::Recording& recording, bool has_load) {
  const auto in = [](const char* what, const std::string& unit) {
    return fmt::format("{} [{}]", what, unit);
  };
  const auto& time = recording.time_unit;
  const auto& way = recording.position_unit;
  std::vector<std::string> headings{
      "PROFILE",         in("TIME", time),   in("FASTEST", recording.velocity_unit),
      in("UP", time),    in("ITS WAY", way), in("DOWN", time),
      in("ITS WAY", way)};
  if (!has_load) return headings;
  headings.push_back(in("SWINGS", way));
  headings.push_back(in("SETTLED", time));
  return headings;
}

json::object load_json(const Profile& profile) {
  const auto& load = *profile.load;
  return {{"swing", load.swing},
          {"unit", profile.recording.position_unit},
          {"settled_s", load.settled ? json::value(*load.settled) : json::value(nullptr)}};
}

}  // namespace

Result<json::array> samples_of(const Profile& profile, const std::vector<double>& times) {
  std::vector<std::size_t> by_time(times.size());
  std::iota(by_time.begin(), by_time.end(), std::size_t{0});
  std::ranges::stable_sort(by_time, {}, [&](std::size_t i) { return times[i]; });
  std::vector<Tick> ticks;
  for (const auto i : by_time) ticks.push_back(profile.setup.tick_at(times[i]));
  const auto motions = profile.simulation->motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  json::array samples(times.size());
  for (std::size_t k = 0; k < by_time.size(); ++k) {
    const auto& motion = (*motions)[k];
    samples[by_time[k]] = json::object{{"t", times[by_time[k]]},
                                       {"x", motion.position},
                                       {"v", motion.velocity},
                                       {"a", motion.acceleration}};
  }
  return samples;
}

json::object to_json(const Profile& profile, json::array samples) {
  const auto& [label, setup, simulation, outcome, recording, load] = profile;
  json::object document{{"generator", setup.generator.name}};
  if (!label.empty()) document["settings"] = label;
  add_time(document, "duration",
           outcome.arrival ? json::value(setup.time_of(*outcome.arrival)) : json::value(nullptr),
           setup);
  document["final_position"] = outcome.at_end.position;
  document["peak_velocity"] = outcome.peak_velocity;
  document["ramp_up"] = ramp_json(ramp_up(outcome, setup), setup);
  document["ramp_down"] = ramp_json(ramp_down(outcome, setup), setup);
  document["phases"] = phases_json(profile);
  document["samples"] = std::move(samples);
  if (load) document["load"] = load_json(profile);
  if (!setup.generator.scales.empty()) document["registers"] = registers_json(setup);
  if (!setup.parameters.empty()) document["parameters"] = parameters_json(setup.parameters);
  return document;
}

Result<std::string> to_csv(const Profile& profile, const Rows& rows) {
  const auto shown = plot::or_usual_columns(rows.shown);
  const auto times = times_of(rows, profile);
  if (!times) return tl::unexpected(times.error());
  std::vector<Tick> ticks;
  for (const double time : *times) ticks.push_back(profile.setup.tick_at(time));
  const auto motions = profile.simulation->motions_at(ticks);
  if (!motions) return tl::unexpected(motions.error());
  std::optional<Jerks> jerks;
  if (std::ranges::count(shown, plot::Quantity::jerk) > 0) {
    auto found = Jerks::of(profile);
    if (!found) return tl::unexpected(found.error());
    jerks = std::move(*found);
  }
  auto text = plot::csv_heading(shown);
  for (std::size_t i = 0; i < times->size(); ++i) {
    text += tmcl::plain_number((*times)[i], 12);
    for (const auto quantity : shown)
      text += ',' + cell(quantity, (*motions)[i], (*times)[i], jerks);
    text += '\n';
  }
  return text;
}

void print_registers(const Profile& profile, std::ostream& out) {
  for (const auto& [name, value, scale] : scaled_registers(profile.setup)) {
    out << fmt::format("{:<12} {} {} = {} ({:x}h)\n", name,
                       tmcl::plain_number(scale->in_unit(value), 10), scale->unit, value, value);
  }
  if (!profile.setup.parameters.empty()) print_parameters(profile.setup.parameters, out);
}

void print_ramps(const Profile& profile, std::ostream& out) {
  const auto& [label, setup, simulation, outcome, recording, load] = profile;
  const auto text = [&, &setup = setup](const Ramp& ramp) {
    return fmt::format("{} {} and {} {}", tmcl::plain_number(ramp.duration, 4),
                       setup.generator.time_unit, ramp.length, setup.generator.length_unit);
  };
  out << "up to speed in " << text(ramp_up(outcome, setup));
  if (const auto down = ramp_down(outcome, setup)) out << ", and down to rest in " << text(*down);
  out << '\n';
}

void print_comparison(const std::vector<Profile>& profiles, std::ostream& out) {
  const auto& given = profiles.front();
  Table table(headings_of(given.recording, given.load.has_value()));
  const Profile* first = nullptr;
  for (const auto& profile : profiles) {
    table.add(row_of(profile));
    if (!profile.load || !profile.load->settled) continue;
    if (first == nullptr || *profile.load->settled < *first->load->settled) first = &profile;
  }
  table.print(out);
  if (first == nullptr || profiles.size() == 1) return;
  out << fmt::format("the load settles first {}, after {} s\n",
                     first == &given ? "as given" : "with " + first->label,
                     tmcl::plain_number(*first->load->settled, 4));
}

}  // namespace tmclctl::profile

// profile solve.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "output/output_file.hpp"
#include "output/print.hpp"
#include "plot/svg_plot.hpp"
#include "plot/text_plot.hpp"
#include "profile/known_values.hpp"
#include "tmcl/plain_number.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;

// Of each of the three parts: a ramp's position is a parabola.
constexpr int points_of_a_part = 100;

std::string_view failure_name(plan::SolveError::Kind kind) {
  switch (kind) {
    case plan::SolveError::Kind::invalid: return "bad_value";
    case plan::SolveError::Kind::insufficient: return "insufficient";
    case plan::SolveError::Kind::contradiction: return "contradiction";
    case plan::SolveError::Kind::impossible: return "impossible";
  }
  return "";
}

Error solve_failure(const plan::SolveError& error, std::string_view unit) {
  auto failure = usage_error(std::string(failure_name(error.kind)), describe(error, unit, "s"));
  json::array quantities;
  for (const auto quantity :
       error.kind == plan::SolveError::Kind::insufficient ? error.candidates : error.culprits)
    quantities.emplace_back(name_of(quantity));
  failure.subject["quantities"] = std::move(quantities);
  return failure;
}

json::object to_json(const plan::Profile& profile, const std::string& unit) {
  json::object document;
  for (const auto quantity : plan::quantities) document[name_of(quantity)] = profile[quantity];
  for (const auto quantity : plan::side_quantities) document[name_of(quantity)] = profile[quantity];
  document["unit"] = unit.empty() ? json::value(nullptr) : json::value(unit);
  return document;
}

void print_table(const plan::Profile& profile, const profile::KnownValues& known, Output& output) {
  Table table({"QUANTITY", "VALUE", ""});
  const auto add = [&](plan::Quantity quantity) {
    table.add({std::string(name_of(quantity)),
               plan::with_unit(quantity, profile[quantity], known.unit, "s"),
               known.given[quantity] ? "given" : ""});
  };
  for (const auto quantity : plan::quantities) add(quantity);
  for (const auto quantity : plan::side_quantities) {
    if (known.given[quantity] || profile[quantity] > 0) add(quantity);
  }
  table.print(output);
}

/// Speeding up, going on, slowing down.
struct Part {
  std::string_view name;
  double duration;
  double acceleration;
};
std::array<Part, 3> parts_of(const plan::Profile& profile) {
  return {{{"acceleration", profile.acceleration_time, profile.acceleration},
           {"constant speed", profile.slew_time, 0},
           {"deceleration", profile.deceleration_time, -profile.deceleration}}};
}

double value_at(plot::Quantity quantity, const plan::Profile& profile, double time,
                const Part& part) {
  switch (quantity) {
    case plot::Quantity::position: return profile.position_at(time);
    case plot::Quantity::velocity: return profile.speed_at(time);
    case plot::Quantity::acceleration: return part.acceleration;
    case plot::Quantity::jerk: break;
  }
  return 0;
}

/// Where one part ends and the next begins, the acceleration has two values.
plot::Curve curve_of(plot::Quantity quantity, const plan::Profile& profile,
                     const std::string& unit) {
  constexpr std::array names{"position", "velocity", "acceleration", "jerk"};
  constexpr std::array per{"", "/s", "/s^2", "/s^3"};
  const auto order = static_cast<std::size_t>(quantity);
  plot::Curve curve{names.at(order), unit + per.at(order), {}, {}};
  double begin = 0;
  for (const auto& part : parts_of(profile)) {
    if (part.duration <= 0) continue;
    for (int i = 0; i <= points_of_a_part; ++i) {
      curve.times.push_back(begin + part.duration * i / points_of_a_part);
      curve.values.push_back(value_at(quantity, profile, curve.times.back(), part));
    }
    begin += part.duration;
  }
  return curve;
}

plot::Picture picture_of(const plan::Profile& profile, const std::string& typed_unit,
                         const plot::Shown& shown) {
  const auto unit = typed_unit.empty() ? "units" : typed_unit;
  const auto number = [](double value) { return tmcl::plain_number(value, 6); };
  plot::Picture picture{
      fmt::format("{} {} in {} s, greatest velocity {} {}/s", number(profile.distance), unit,
                  number(profile.total_time), number(profile.speed), unit),
      "s",
      {},
      {}};
  for (const auto quantity : plot::or_usual(shown))
    picture.curves.push_back(curve_of(quantity, profile, unit));
  double begin = 0;
  for (const auto& part : parts_of(profile)) {
    if (part.duration > 0) picture.marks.push_back({begin, std::string(part.name)});
    begin += part.duration;
  }
  return picture;
}

/// The one that begins at this time, or is under way.
Part part_at(const plan::Profile& profile, double time) {
  const auto parts = parts_of(profile);
  auto part = parts.begin();
  for (double end = part->duration; time >= end && std::next(part) != parts.end();
       end += part->duration)
    ++part;
  return *part;
}

/// What is shown, every so often.
Result<std::string> to_csv(const plan::Profile& profile, double step, const plot::Shown& shown) {
  constexpr double rounding = 1e-9;
  const double last = std::floor(profile.total_time / step + rounding);
  if (!(last < plot::most_csv_rows)) {
    return tl::unexpected(
        usage_error("too_many_rows", fmt::format("--csv {} makes {:.0f} rows; {:.0f} at most", step,
                                                 last + 1, plot::most_csv_rows)));
  }
  auto text = plot::csv_heading(shown);
  for (double i = 0; i <= last; ++i) {
    const auto time = std::min(i * step, profile.total_time);
    const auto part = part_at(profile, time);
    text += tmcl::plain_number(time, 12);
    for (const auto quantity : shown)
      text += ',' + tmcl::plain_number(value_at(quantity, profile, time, part), 12);
    text += '\n';
  }
  return text;
}

Result<void> show(const verb::SolveProfile& verb, const plan::Profile& profile,
                  const profile::KnownValues& known, Output& output) {
  if (verb.csv_step) {
    return to_csv(profile, *verb.csv_step, plot::or_usual_columns(verb.show))
        .map([&](const std::string& text) { output.out << text; });
  }
  const auto picture = picture_of(profile, known.unit, verb.show);
  if (!verb.svg.empty()) {
    OutputFile svg;
    auto written = svg.open(verb.svg).and_then([&] { return svg.write(plot::to_svg(picture)); });
    if (!written) return written;
  }
  if (output.json) {
    print_json(to_json(profile, known.unit), output);
    return {};
  }
  print_table(profile, known, output);
  if (verb.svg.empty()) output.out << '\n' << plot::to_text(picture, output.out_screen);
  return {};
}

Result<ExitCode> run(const verb::SolveProfile& verb, Output& output) {
  const auto known = profile::read_known_values(verb.words);
  if (!known) return tl::unexpected(known.error());
  const auto solved = plan::solve(known->given, known->assumption);
  if (!solved) return tl::unexpected(solve_failure(solved.error(), known->unit));
  return show(verb, *solved, *known, output).map([] { return ExitCode::done; });
}

constexpr const char* solve_help = R"(
A movement that accelerates, goes at constant speed and decelerates has eight values, of which four
that do not follow from each other determine the rest:
  distance, speed, acceleration, deceleration, acceleration_time, slew_time (at constant speed),
  deceleration_time, total_time
It goes from rest to rest, unless initial_speed and final_speed, both below speed, are given. The
distances of the parts may be given, too, each with another value of the same part:
  acceleration_distance, slew_distance, deceleration_distance
With an assumption, fewer are enough:
  symmetric  both ramps are equal: one acceleration, and one time if both ends have the same speed
  thirds     symmetric, and each of the three parts takes a third of the time; between ends with
             different speeds the times are equal, and not the accelerations

  tmclctl profile solve distance=20mm total_time=600ms thirds
  tmclctl profile solve speed=8 acceleration=16 deceleration=16 distance=12
  tmclctl profile solve distance=90deg speed=1rev/s acceleration=5rev/s^2 symmetric
  tmclctl --json profile solve distance=200mm total_time=1s speed=250mm/s symmetric
  tmclctl profile solve initial_speed=2 speed=8 acceleration=3 deceleration=3 distance=40

Prints all of them as a table and draws position and speed, or what --show names; --svg draws into a
file; --csv prints rows of the movement instead; --json prints plain numbers, and "unit". Lengths may be in any unit, all of them in the same one; mm, um,
cm, m and in, and deg, rad and rev, can be mixed. Speeds are such as mm/s, accelerations mm/s^2 (or
mm/s2, mm/s/s); times are in s, ms, us or min. What is printed is in seconds and in the first unit
of length that was given, and bare numbers are taken as such.

More than enough may be given, as long as it agrees within 1e-9. Too little, values that contradict
each other, and what is impossible are errors that say so, with a way out (exit code 2).
)";

}  // namespace

void add_solve(Grammar& grammar, const Form& profile) {
  auto solve = grammar.verb<verb::SolveProfile>(
      profile, "solve", access::offline("it computes, and asks no module"),
      "All of a trapezoid from as much as determines it", solve_help, run);
  auto& said = *solve.operator->();
  solve.words("QUANTITY=VALUE[UNIT]", "What is known, and the words symmetric or thirds",
              texts(said.words));
  plot::add_show(solve, solve->show);
  solve.option("--csv", "SECONDS",
               "Print t,x,v,a, or what --show names, every so often instead of all that",
               number(solve->csv_step, 1e-9, 1e9));
  solve.object([](const verb::SolveProfile& verb, bool json) {
    return verb.csv_step && (json || !verb.svg.empty()) ? "--csv excludes --json and --svg" : "";
  });
  solve.option("--svg", "FILE", "Draw into this file, not on the screen", svg_file(solve->svg));
}

}  // namespace tmclctl

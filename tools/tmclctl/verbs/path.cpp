// path check.
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "api/course_view.hpp"
#include "command_line/text_problems.hpp"
#include "config/load.hpp"
#include "gateway/journey/path_words.hpp"
#include "output/output_file.hpp"
#include "output/print.hpp"
#include "path/course_rows.hpp"
#include "path/leg_table.hpp"
#include "path/path_source.hpp"
#include "path_words.hpp"
#include "profile/setup.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl {
namespace {

namespace plan = tmcl::plan;

constexpr double unlimited = std::numeric_limits<double>::infinity();

Error failure_of(const verb::CheckPath& verb, const plan::PathObjection& objection,
                 Output& output) {
  if (!objection.problems.empty())
    return error_from(verb.file, objection.problems, tmcl::plan::most_text_problems, output);
  auto failure = usage_error(objection.name, verb.file + ": " + objection.message);
  failure.kind = tmcl::client::kind_of_objection(objection.name);
  return failure;
}

/// What --machine says of paths.
Result<tmcld::PathConfig> machine_of(const verb::CheckPath& verb) {
  if (verb.machine.empty()) return tmcld::PathConfig{};
  auto loaded = tmcld::load_config(verb.machine);
  if (loaded) return std::move(loaded->config.path);
  return tl::unexpected(
      usage_error("bad_config", fmt::format("{}", fmt::join(loaded.error(), "\n"))));
}

plan::path_file::GcodeSetup setup_of(const verb::CheckPath& verb,
                                     const tmcld::PathConfig& machine) {
  auto setup = tmcld::setup_of(machine);
  if (verb.lenient) setup.unknowns = plan::path_file::Unknowns::skipped;
  return setup;
}

/// Where it goes, and what it switches.
tmcl::api::path::Course view_of(const plan::Course& planned, const plan::PathSource& source,
                                const tmcld::PathConfig& machine) {
  auto course = tmcld::view_of(planned, source.path.axes);
  for (auto& word : course.words) word.switches = to_string(machine.words.at(word.number));
  return course;
}

/// Of the loads behind the axes.
std::optional<tmcl::ramp::Resonance> resonance_of(const verb::ShapedPath& said) {
  if (!said.resonance_hz) return std::nullopt;
  return tmcl::ramp::Resonance{*said.resonance_hz,
                               said.damping.value_or(tmcl::ramp::usual_load_damping)};
}

std::optional<plan::Shaping> shaping_of(const verb::ShapedPath& said) {
  if (!said.shaper) return std::nullopt;
  return plan::Shaping{*said.shaper, *resonance_of(said)};
}

plan::PathResult<plan::Course> course_of(const verb::CheckPath& verb,
                                         const plan::PathSource& source, double jerk) {
  plan::PathLimits limits;
  limits.axis.fill({verb.velocity, verb.acceleration, verb.corner_jump.value_or(unlimited)});
  limits.jerk = jerk;
  return plan::course_of(source, limits, verb.feed.value_or(unlimited), verb.tolerance,
                         shaping_of(verb.shaping));
}

/// What its jerk makes of a course; nothing without one.
std::optional<tmcl::api::path::JerkLimit> jerk_limit_of(const verb::CheckPath& verb,
                                                        const plan::Course& course,
                                                        const plan::PathSource& source) {
  if (!verb.jerk) return std::nullopt;
  const auto plain = course_of(verb, source, unlimited).value();
  return tmcld::view_of_jerk(course, plain, resonance_of(verb.shaping), source.path.axes);
}

std::string corners_warning(const verb::CheckPath& verb) {
  return fmt::format(
      "shaped, the path leaves its corners by more than the tolerance of {}: a lower "
      "--acceleration, or a dwell in the corner, keeps nearer to them",
      tmcl::plain_number(verb.tolerance, 6));
}

/// As the file has it, with arcs.
plan::path_file::Path drawn_path(const std::string& text, const plan::PathSource& source,
                                 const plan::path_file::GcodeSetup& setup) {
  if (source.format == plan::PathFormat::csv) return source.path;
  return plan::path_file::read_gcode(text, {}, setup).value_or(source.path);
}

std::vector<path::DrawnPath::Nearest> nearest_of(path::DrawnPath drawn,
                                                 const tmcl::api::path::Curve& curve) {
  std::vector<path::DrawnPath::Nearest> nearest;
  for (std::size_t i = 0; i < curve.positions.size(); ++i) {
    path::DrawnPath::Point point{};
    std::ranges::copy(curve.positions[i], point.begin());
    nearest.push_back(drawn.nearest(curve.times_s[i], point));
  }
  return nearest;
}

Result<void> write_picture(const verb::CheckPath& verb, const std::string& picture) {
  OutputFile svg;
  return svg.open(verb.svg).and_then([&] { return svg.write(picture); });
}

Result<void> write_rows(const verb::CheckPath& verb, const plan::Course& course,
                        const plan::path_file::Path& drawn, Output& output) {
  const auto rows =
      path::to_csv(course, drawn.axes, path::DrawnPath(drawn, course), {verb.csv_step, verb.show});
  if (!rows) return tl::unexpected(rows.error());
  if (verb.csv == "-") return output.out << *rows, Result<void>();
  OutputFile csv;
  return csv.open(verb.csv).and_then([&] { return csv.write(*rows); });
}

/// What the legs are for other programs; they have registers.
std::string exported(const verb::CheckPath& verb, const boost::json::array& legs,
                     const path::ChipScale& chip) {
  if (*verb.as == profile::ExportForm::c) return path::legs_in_c(legs, chip);
  return path::legs_in_tmcl(legs, *verb.as == profile::ExportForm::tmc);
}

Result<ExitCode> run(const verb::CheckPath& verb, Output& output) {
  const auto text = path::text_of(verb.file, path::most_path_bytes);
  if (!text) return tl::unexpected(text.error());
  const auto machine = machine_of(verb);
  if (!machine) return tl::unexpected(machine.error());
  const auto setup = setup_of(verb, *machine);
  const auto source =
      plan::read_path(*text, plan::format_of(verb.file, *text), verb.tolerance, setup);
  if (!source) return tl::unexpected(failure_of(verb, source.error(), output));
  auto warnings = plan::warnings_of(*source);
  const auto shaping = shaping_of(verb.shaping);
  const auto planned = course_of(verb, *source, verb.jerk.value_or(unlimited));
  if (!planned) return tl::unexpected(failure_of(verb, planned.error(), output));
  const auto course = view_of(*planned, *source, *machine);
  const auto shaped = tmcld::view_of(*planned, shaping, source->path.axes);
  const auto smooth = jerk_limit_of(verb, *planned, *source);
  if (shaped && shaped->off_path > verb.tolerance) warnings.push_back(corners_warning(verb));
  warn(warnings, output);
  tmcl::api::path::Curve curve;
  if (!verb.svg.empty() || !verb.show.empty())
    curve = tmcld::curve_of(*planned, tmcl::api::path::most_curve_points);
  path::Drawn drawing{verb.show, {}};
  if (!shaping && !verb.jerk) drawing.phases = path::phases_of(*planned);
  if (!verb.svg.empty()) {
    drawing.tolerance = verb.tolerance;
    drawing.nearest =
        nearest_of(path::DrawnPath(drawn_path(*text, *source, setup), *planned), curve);
    if (auto drawn = write_picture(verb, path::to_svg(verb.file, course, curve, drawing)); !drawn)
      return tl::unexpected(drawn.error());
  }
  boost::json::array legs;
  std::optional<path::ChipScale> chip;
  if (verb.microsteps_per_unit) chip = path::ChipScale{*verb.microsteps_per_unit, verb.clock_hz};
  if (verb.legs) legs = path::leg_table(*planned, source->path.axes, chip);
  const auto beyond = chip ? path::beyond_registers(legs, *chip) : std::vector<std::string>();
  // Nothing is exported that a module would refuse.
  if (verb.as && !beyond.empty())
    return tl::unexpected(usage_error("out_of_range", verb.file + ": " + beyond.front()));
  warn(beyond, output);
  if (!verb.csv.empty()) {
    if (auto written = write_rows(verb, *planned, drawn_path(*text, *source, setup), output);
        !written)
      return tl::unexpected(written.error());
  }
  if (verb.as && legs.empty()) {
    return tl::unexpected(usage_error(
        "bad_path", verb.file + ": a table with times has no legs, and so no registers of them"));
  }
  if (verb.as) {
    output.out << exported(verb, legs, *chip);
  } else if (output.json) {
    auto document = tmcl::api::to_json(course);
    if (verb.legs) document["leg_table"] = std::move(legs);
    if (shaped) document["shaping"] = tmcl::api::to_json(*shaped);
    if (smooth) document["jerk"] = tmcl::api::to_json(*smooth);
    document["file"] = verb.file;
    document["warnings"] = boost::json::array(warnings.begin(), warnings.end());
    print_json(document, output);
  } else if (verb.csv != "-") {
    path::print(verb.file, course, output);
    if (smooth) path::print(*smooth, output);
    if (shaped) path::print(*shaped, output);
    if (verb.legs) path::print_legs(legs, output);
    if (!verb.show.empty() && verb.svg.empty())
      output.out << '\n' << path::drawing(verb.file, course, curve, drawing, output.out_screen);
  }
  return ExitCode::done;
}

Reading read_leg_form(const std::string& text, std::optional<profile::ExportForm>& into) {
  const auto form = profile::export_form(text);
  if (!form || *form == profile::ExportForm::json)
    return tl::unexpected(fmt::format("'{}' is none of sap, tmc and c", text));
  into = *form;
  return {};
}

constexpr const char* path_help = R"(
  tmclctl path check --help
  tmclctl path run --help
  tmclctl path pause --help
)";

constexpr const char* path_check_help = R"(
Plans a path as 'tmclctl path run' would, for axes that can do what --velocity and --acceleration say,
and says how long it is and takes, where it goes, and where it is slowest. Lengths are in the units of
the file; G-code's are mm (deg for A B C). Where X, Y or Z moves, the length is theirs, and A B C go
along. All that is wrong comes as FILE:LINE:COLUMN: MESSAGE, up to 20 problems. What of G-code moves no
axis, such as S, T and M6, is a warning, once for each; with --lenient words that are not known are, too:
without them the path may be another one than the program means. M3 to M9 are warnings, too, unless the
section [path] of tmcld's configuration says what they switch; --machine names that file, and what is
switched is listed then. M0 waits: how often is said.

--svg draws the path, and as a line how far it is from the lines and arcs of the file, ten times as far,
where it is not on them: chords instead of arcs, cubics, corners that --shape cuts.
--show draws the axes over time, on the screen or below the path in --svg, with T1 to T4 of each leg or,
where there are more than four, with the slowest corners.
--legs says for each leg when it begins (T1), has its speed (T2), slows down (T3) and ends (T4), and the
ramp of each axis, as ramp generators take it: start, greatest and stop velocity, both accelerations.
With --microsteps-per-unit the ramps come in microsteps as well, and as the registers of a TMC5130,
TMC5160 or TMC5072 hold them at --clock: f/2^24 and f^2/2^41, VSTOP 10 at least. What is beyond a
register is a warning with the number that would do, and with --as an error. --as prints them for other programs: c is a table of
registers; sap are lines of TMCL, and tmc is a program that 'tmclctl program' assembles, for a module whose
motors 0, 1 ... are the axes.
--csv is for other programs, too: time, X_x, X_v, X_a and X_j of each axis, and off, which is how far the
axes are from the lines and arcs of the file, where chords stand in for an arc or cubics for the rows of a
table with times. Where a velocity jumps, in a corner, there is no acceleration to tell.
--shape passes the path as the mean of itself at two or three times, so that loads which swing at
--resonance hardly swing after it. That takes half a swing (zv) or a swing longer, and cuts corners; how
much is said. zv and zvd leave nothing at the resonance, zvd little near it; ei 5 % in a wider range.
--jerk lets the acceleration along the path change gradually, by no more than that in a second. The axes
stay on the path, within all limits at each place; it takes longer, and how much is said. With --resonance
it is also said what that gains for loads that swing. In a corner a velocity still changes at once:
--corner-jump limits that. Both together: the path with the jerk is what is shaped.

  tmclctl path check part.ngc --velocity 20 --acceleration 500
  tmclctl path check part.csv --svg part.svg
  tmclctl path check part.ngc --show v,a
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240 --as c
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240 --as tmc
  tmclctl path check part.ngc --csv part.csv --step 0.01
  tmclctl path check part.ngc --machine /etc/tmcld/tmcld.toml
  tmclctl path check part.ngc --shape zvd --resonance 12Hz --damping 0.05
  tmclctl path check part.ngc --acceleration 400 --jerk 4800 --resonance 12Hz
  tmclctl --json path check part.ngc
)";

}  // namespace

Form add_path(Grammar& grammar) {
  const auto group =
      grammar.group("path", "Paths through several axes, from tables and G-code", path_help);
  auto check = grammar.verb<verb::CheckPath>(
      group, "check", access::offline("it computes, and asks no module"),
      "How a path would be passed, without axes", path_check_help, run);
  add_path_file(check);
  check.option("--machine", "FILE",
               "A configuration of tmcld: what its [path] says of M words holds here, too",
               text(check->machine));
  check.option("--feed", "UNITS", "No faster along the path, a second",
               number(check->feed, least_of_path, most_of_path));
  check.option("--velocity", "UNITS", "What an axis can do, a second (default 100)",
               number(check->velocity, least_of_path, most_of_path));
  check.option("--acceleration", "UNITS", "And a second squared (default 1000)",
               number(check->acceleration, least_of_path, most_of_path));
  check.option("--corner-jump", "UNITS",
               "By how much an axis may change its speed at once in a corner, a second",
               number(check->corner_jump, least_of_path, most_of_path));
  check.option("--jerk", "UNITS",
               "By how much the acceleration along the path may change, a second cubed",
               number(check->jerk, least_of_path, most_of_path));
  add_shaping(check);
  plot::add_show(check, check->show);
  auto& said = *check.operator->();
  check.option("--as", "FORM",
               "With --legs --microsteps-per-unit: print them for other programs: sap, tmc or c",
               [&said](const std::string& text) { return read_leg_form(text, said.as); });
  check.option("--csv", "FILE",
               "Write position, velocity, acceleration and jerk of each axis over time, or what "
               "--show names, and the distance from the path; '-': to standard output instead",
               text(check->csv));
  check.option("--step", "SECONDS", "Between the rows of --csv (default 0.001)",
               number(check->csv_step, least_of_path, most_of_path));
  check.object([](const verb::CheckPath& verb, bool json) {
    if (verb.legs && verb.shaping.shaper) return "--legs and --shape exclude each other";
    if (verb.legs && verb.jerk) return "--legs and --jerk exclude each other";
    if (verb.as && (!verb.legs || !verb.microsteps_per_unit))
      return "--as needs --legs and --microsteps-per-unit";
    if (verb.as && json) return "--as and --json exclude each other";
    if (verb.csv == "-" && json) return "--json and '--csv -' both want standard output";
    if (verb.csv == "-" && verb.as) return "--as and '--csv -' both want standard output";
    return objection_to(verb.shaping, verb.jerk.has_value());
  });
  check.flag("--legs", "When each leg speeds up and slows down, and the ramp of each axis",
             check->legs);
  check.option("--microsteps-per-unit", "NUMBER",
               "With --legs: the ramps in microsteps and as registers, too",
               number(check->microsteps_per_unit, least_of_path, most_of_path));
  check.option("--clock", "HZ", "Of the chip with those registers (default 16 MHz)",
               number(check->clock_hz, profile::least_clock_hz, profile::greatest_clock_hz));
  return group;
}

}  // namespace tmclctl

// path check.
#include <limits>

#include "api/course_view.hpp"
#include "command_line/text_problems.hpp"
#include "output/print.hpp"
#include "path/leg_table.hpp"
#include "path/path_source.hpp"
#include "path_words.hpp"
#include "profile/setup.hpp"

namespace tmclctl {
namespace {

namespace plan = tmcl::plan;

Error failure_of(const verb::CheckPath& verb, const plan::PathObjection& objection,
                 Output& output) {
  if (!objection.problems.empty())
    return error_from(verb.file, objection.problems, tmcl::plan::most_text_problems, output);
  auto failure = usage_error(objection.name, verb.file + ": " + objection.message);
  failure.kind = tmcl::client::kind_of_objection(objection.name);
  return failure;
}

Result<ExitCode> run(const verb::CheckPath& verb, Output& output) {
  const auto text = path::text_of(verb.file, path::most_path_bytes);
  if (!text) return tl::unexpected(text.error());
  const auto source = plan::read_path(*text, plan::format_of(verb.file, *text), verb.tolerance);
  if (!source) return tl::unexpected(failure_of(verb, source.error(), output));
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  plan::PathLimits limits;
  limits.axis.fill({verb.velocity, verb.acceleration, verb.corner_jump.value_or(unlimited)});
  const double feed = verb.feed.value_or(unlimited);
  const auto planned = plan::course_of(*source, limits, feed, verb.tolerance);
  if (!planned) return tl::unexpected(failure_of(verb, planned.error(), output));
  const auto course = tmcld::view_of(*planned, source->path.axes);
  tmcl::api::path::Curve curve;
  if (!verb.svg.empty() || !verb.show.empty())
    curve = tmcld::curve_of(*planned, tmcl::api::path::most_curve_points);
  const path::Drawn drawing{verb.show, path::phases_of(*planned)};
  if (!verb.svg.empty()) {
    if (const auto drawn = path::draw(verb.svg, verb.file, course, curve, drawing); !drawn)
      return tl::unexpected(drawn.error());
  }
  boost::json::array legs;
  std::optional<path::ChipScale> chip;
  if (verb.microsteps_per_unit) chip = path::ChipScale{*verb.microsteps_per_unit, verb.clock_hz};
  if (verb.legs) legs = path::leg_table(*planned, source->path.axes, chip);
  if (chip) warn(path::beyond_registers(legs, *chip), output);
  if (verb.in_c && legs.empty()) {
    return tl::unexpected(usage_error(
        "bad_path", verb.file + ": a table with times has no legs, and so no registers of them"));
  }
  if (verb.in_c) {
    output.out << path::legs_in_c(legs, *chip);
  } else if (output.json) {
    auto document = tmcl::api::to_json(course);
    if (verb.legs) document["leg_table"] = std::move(legs);
    document["file"] = verb.file;
    print_json(document, output);
  } else {
    path::print(verb.file, course, output);
    if (verb.legs) path::print_legs(legs, output);
    if (!verb.show.empty() && verb.svg.empty())
      output.out << '\n' << path::drawing(verb.file, course, curve, drawing, output.out_screen);
  }
  return ExitCode::done;
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
along. All that is wrong comes as FILE:LINE:COLUMN: MESSAGE, up to 20 problems.

--show draws the axes over time, on the screen or below the path in --svg, with T1 to T4 of each leg or,
where there are more than four, with the slowest corners.
--legs says for each leg when it begins (T1), has its speed (T2), slows down (T3) and ends (T4), and the
ramp of each axis, as ramp generators take it: start, greatest and stop velocity, both accelerations.
With --microsteps-per-unit the ramps come in microsteps as well, and as the registers of a TMC5130,
TMC5160 or TMC5072 hold them at --clock: f/2^24 and f^2/2^41, VSTOP 10 at least. What is beyond a
register is a warning with the number that would do.

  tmclctl path check part.ngc --velocity 20 --acceleration 500
  tmclctl path check part.csv --svg part.svg
  tmclctl path check part.ngc --show v,a
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240
  tmclctl path check part.ngc --legs --microsteps-per-unit 10240 --as c
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
  check.option("--feed", "UNITS", "No faster along the path, a second",
               number(check->feed, least_of_path, most_of_path));
  check.option("--velocity", "UNITS", "What an axis can do, a second (default 100)",
               number(check->velocity, least_of_path, most_of_path));
  check.option("--acceleration", "UNITS", "And a second squared (default 1000)",
               number(check->acceleration, least_of_path, most_of_path));
  check.option("--corner-jump", "UNITS",
               "By how much an axis may change its speed at once in a corner, a second",
               number(check->corner_jump, least_of_path, most_of_path));
  plot::add_show(check, check->show);
  auto& said = *check.operator->();
  check.option("--as", "c",
               "With --legs --microsteps-per-unit: print the registers as a table in C",
               [&said](const std::string& text) -> Reading {
                 if (text != "c") return tl::unexpected(fmt::format("'{}' is not c", text));
                 said.in_c = true;
                 return {};
               });
  check.object([](const verb::CheckPath& verb, bool json) {
    if (verb.in_c && (!verb.legs || !verb.microsteps_per_unit))
      return "--as c needs --legs and --microsteps-per-unit";
    return verb.in_c && json ? "--as and --json exclude each other" : "";
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

// What needs neither a bus nor a module.
#include "grammar.hpp"
#include "help_text.hpp"
#include "profile/generators.hpp"

namespace tmclctl {
namespace {

constexpr double longest_simulated_time = 1e9;
constexpr double shortest_csv_step = 1e-9;
constexpr double least_of_path = 1e-9;
constexpr double most_of_path = 1e9;
constexpr int shortest_period_ms = 1;
constexpr int longest_period_ms = 1000;

tl::expected<void, std::string> read_choice(const std::string& text,
                                            std::vector<std::string>& choices) {
  const auto equals = text.find('=');
  if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
    return tl::unexpected(fmt::format("'{}' is no NAME=AXIS", text));
  choices.push_back(text);
  return {};
}

tl::expected<void, std::string> read_times(std::string_view list, std::vector<double>& times) {
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

tl::expected<void, std::string> read_change(const std::string& text,
                                            std::vector<verb::Simulate::Change>& changes) {
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

std::string objection_to(const verb::Simulate& said, bool json) {
  const int forms = (json ? 1 : 0) + (said.csv_step ? 1 : 0) + (said.svg.empty() ? 0 : 1);
  if (forms > 1) return "--json, --csv and --svg exclude each other";
  return !said.samples.empty() && !json ? "--sample needs --json" : "";
}

void add_simulate(Grammar& grammar, const Form& profile) {
  auto simulate = grammar.verb<verb::Simulate>(
      profile, "simulate", "What a chip's ramp generator makes of registers", help_text::simulate);
  simulate.required_option("--generator", "NAME", generator_names(), text(simulate->generator));
  auto& said = *simulate.operator->();
  simulate.words("REGISTER=VALUE",
                 "What is written before it starts; the others stay as at power-up",
                 [&said](const std::string& text) -> tl::expected<void, std::string> {
                   said.settings.push_back(text);
                   return {};
                 });
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
  simulate.object(objection_to);
}

void add_solve(Grammar& grammar, const Form& profile) {
  auto solve = grammar.verb<verb::SolveProfile>(
      profile, "solve", "All of a trapezoid from as much as determines it", help_text::solve);
  auto& said = *solve.operator->();
  solve.words("QUANTITY=VALUE[UNIT]", "What is known, and the words symmetric or thirds",
              [&said](const std::string& text) -> tl::expected<void, std::string> {
                said.words.push_back(text);
                return {};
              });
  solve.option("--svg", "FILE", "Draw into this file, not on the screen", svg_file(solve->svg));
}

/// What is asked of a path, whether it is passed or only checked.
template <class T>
void add_path_file(VerbForm<T>& form) {
  const auto in_units = [](auto& into) { return number(into, least_of_path, most_of_path); };
  form.word("FILE", "A table (.csv) or G-code", text(form->file));
  form.option("--tolerance", "UNITS", "How far from it the path may be passed (default 0.05)",
              in_units(form->tolerance));
  form.option("--svg", "FILE", "Draw the path and its axes into this file", svg_file(form->svg));
}

void add_steering(Grammar& grammar, const Form& path, const std::string& name, const char* method,
                  const std::string& description) {
  auto form = grammar.verb<verb::Ask>(path, name, description, help_text::path_steering);
  form->method = method;
  auto& said = *form.operator->();
  form.words("AXIS", "One of each path; without any, all paths",
             [&said](const std::string& text) -> tl::expected<void, std::string> {
               said.axes.push_back(text);
               return {};
             });
}

}  // namespace

void add_profile(Grammar& grammar) {
  const auto profile =
      grammar.group("profile", "Compute movements, without any module", help_text::profile);
  add_simulate(grammar, profile);
  add_solve(grammar, profile);
}

void add_mint(Grammar& grammar) {
  const auto mint = grammar.group("mint", "Movements in the words of Mint", help_text::mint);
  auto check = grammar.verb<verb::CheckMint>(
      mint, "check", "What a Mint program would do, without doing it", help_text::mint_check);
  check.word("FILE", "The program", text(check->file));
  auto run = grammar.verb<verb::RunMint>(mint, "run", "Move axes as a Mint program says",
                                         help_text::mint_run);
  run.word("FILE", "The program", text(run->file));
  auto& said = *run.operator->();
  run.repeated_option("--axis", "NUMBER=AXIS", "Which axis the program's axis of this number is",
                      [&said](const std::string& text) { return read_choice(text, said.axes); });
  run.option("--counts", "WHAT", "What SCALE counts: microsteps (default), or encoder",
             [&said](const std::string& text) -> tl::expected<void, std::string> {
               said.counts_encoder = text == "encoder";
               if (said.counts_encoder || text == "microsteps") return {};
               return tl::unexpected(fmt::format("'{}' is neither microsteps nor encoder", text));
             });
}

void add_path(Grammar& grammar) {
  const auto path =
      grammar.group("path", "Paths through several axes, from tables and G-code", help_text::path);
  auto check = grammar.verb<verb::CheckPath>(
      path, "check", "How a path would be passed, without axes", help_text::path_check);
  add_path_file(check);
  check.option("--feed", "UNITS", "No faster along the path, a second",
               number(check->feed, least_of_path, most_of_path));
  check.option("--velocity", "UNITS", "What an axis can do, a second (default 100)",
               number(check->velocity, least_of_path, most_of_path));
  check.option("--acceleration", "UNITS", "Likewise, a second squared (default 1000)",
               number(check->acceleration, least_of_path, most_of_path));
  check.option("--corner-jump", "UNITS",
               "By how much an axis may change its speed at once in a corner, a second",
               number(check->corner_jump, least_of_path, most_of_path));
  check.flag("--legs", "When each leg speeds up and slows down, and the ramp of each axis",
             check->legs);
  check.option("--microsteps-per-unit", "NUMBER", "With --legs: the ramps in microsteps, too",
               number(check->microsteps_per_unit, least_of_path, most_of_path));
  auto run =
      grammar.verb<verb::RunPath>(path, "run", "Move axes along a path", help_text::path_run);
  add_path_file(run);
  auto& said = *run.operator->();
  run.repeated_option("--axis", "LETTER=AXIS", "Which axis the file's axis of this name is",
                      [&said](const std::string& text) { return read_choice(text, said.axes); });
  run.option("--mode", "MODE", "velocity (default), segments, or position",
             [&said](const std::string& text) -> tl::expected<void, std::string> {
               const auto mode = tmcl::plan::stream_mode_named(text);
               if (!mode) {
                 return tl::unexpected(
                     fmt::format("'{}' is none of velocity, segments and position", text));
               }
               said.mode = *mode;
               return {};
             });
  run.option("--deviation", "UNITS",
             "Stop when an axis is seen so far off its plan (default 20 tolerances)",
             number(run->deviation, least_of_path, most_of_path));
  run.option("--feed", "UNITS|VELOCITY", "No faster along the path: a second, or such as 20mm/s",
             text(run->feed));
  run.option("--velocity", "UNITS|VELOCITY", "No axis faster than this; otherwise max_velocity",
             text(run->velocity));
  run.option("--acceleration", "UNITS|ACCELERATION",
             "Likewise, a second squared, or such as 500mm/s^2; otherwise the least of its own",
             text(run->acceleration));
  run.option("--corner-jump", "UNITS|VELOCITY",
             "By how much an axis may change its speed at once in a corner, such as 2mm/s",
             text(run->corner_jump));
  run.option("--per-turn", "UNITS", "What a turn of the motor is, for axes without a unit",
             number(run->per_turn, least_of_path, most_of_path));
  run.option(
      "--period", "MS", "In velocity mode, no updates more often than this (default 5)",
      [&said](const std::string& text) {
        return parse_number<int>(text, shortest_period_ms, longest_period_ms).map([&](int value) {
          said.period = std::chrono::milliseconds(value);
        });
      });
  run.flag("--dry-run", "Plan and check everything; move nothing", run->dry_run);
  add_steering(grammar, path, "pause", "path.pause", "Let axes stand on their path");
  add_steering(grammar, path, "resume", "path.resume", "Let them go on");
  add_steering(grammar, path, "stop", "path.stop", "End paths: the axes stop");
}

Form add_program(Grammar& grammar) {
  const auto program =
      grammar.group("program", "Stand-alone programs: text, bytes, and modules that run them",
                    help_text::program);
  auto assemble = grammar.verb<verb::Assemble>(
      program, "assemble", "Make a program file of a program's text", help_text::assemble);
  assemble.word("FILE", "The text", text(assemble->file));
  assemble.option("-o,--output", "FILE", "Write the program into this file",
                  text(assemble->output));
  assemble.option("--model", "MODEL", "Whose parameters TMCLParam.tmc names, such as TMCM-1110",
                  text(assemble->model));
  assemble.flag("--listing", "Print the listing, too: addresses, bytes and text",
                assemble->listing);
  auto disassemble = grammar.verb<verb::Disassemble>(
      program, "disassemble", "Make text of a program file", help_text::disassemble);
  disassemble.word("FILE", "The program file", text(disassemble->file));
  disassemble.option("-o,--output", "FILE", "Write the text into this file, do not print it",
                     text(disassemble->output));
  return program;
}

}  // namespace tmclctl

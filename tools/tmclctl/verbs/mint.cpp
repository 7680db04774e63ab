// mint check.
#include <fmt/format.h>

#include "command_line/text_problems.hpp"
#include "output/print.hpp"
#include "path/path_source.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/plan/mint.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;
namespace mint = tmcl::plan::mint;

json::object to_json(const mint::Move& move) {
  json::object document{{"axis", move.axis},   {"line", move.line},
                        {"scale", move.scale}, {"start", move.start},
                        {"end", move.end},     {"duration_s", move.duration()}};
  if (!move.profile) return document;
  json::object profile;
  for (const auto quantity : plan::quantities)
    profile[name_of(quantity)] = (*move.profile)[quantity];
  document["profile"] = std::move(profile);
  return document;
}

json::object to_json(const std::string& file, const mint::DryRun& run) {
  json::array groups;
  for (const auto& group : run.groups) {
    json::array moves;
    for (const auto& move : group.moves) moves.push_back(to_json(move));
    groups.push_back(json::object{{"line", group.line},
                                  {"start_s", group.start_time},
                                  {"duration_s", group.duration},
                                  {"moves", std::move(moves)}});
  }
  json::array warnings;
  for (const auto& warning : run.warnings) warnings.emplace_back(describe(warning, file));
  return {{"file", file},
          {"duration_s", run.duration},
          {"groups", std::move(groups)},
          {"warnings", std::move(warnings)}};
}

void print_table(const mint::DryRun& run, Output& output) {
  Table table({"GO", "START", "AXIS", "FROM", "TO", "TIME", "SPEED", "ACCELERATES", "SLEWS",
               "DECELERATES"});
  const auto number = [](double value) { return tmcl::plain_number(value, 6); };
  const auto seconds = [&](double value) { return number(value) + " s"; };
  for (const auto& group : run.groups) {
    for (const auto& move : group.moves) {
      const auto profile = move.profile.value_or(plan::Profile{});
      table.add({fmt::format("line {}", group.line), seconds(group.start_time),
                 fmt::format("{}", move.axis), number(move.start), number(move.end),
                 seconds(move.duration()), number(profile.speed),
                 seconds(profile.acceleration_time), seconds(profile.slew_time),
                 seconds(profile.deceleration_time)});
    }
  }
  table.print(output);
}

Result<mint::DryRun> dry_run(const std::string& file, Output& output) {
  const auto text = path::text_of(file, path::most_mint_bytes);
  if (!text) return tl::unexpected(text.error());
  return mint::read(*text)
      .and_then([](const mint::Program& program) { return mint::dry_run(program); })
      .map_error([&](const tmcl::TextProblems& problems) {
        return error_from(file, problems, tmcl::plan::most_text_problems, output);
      });
}

Result<ExitCode> run(const verb::CheckMint& verb, Output& output) {
  return dry_run(verb.file, output).map([&](const mint::DryRun& run) {
    if (output.json) {
      print_json(to_json(verb.file, run), output);
    } else {
      for (const auto& warning : run.warnings) warn(describe(warning, verb.file), output);
      print_table(run, output);
    }
    return ExitCode::done;
  });
}

constexpr const char* mint_help = R"(
  tmclctl mint check --help
  tmclctl mint run --help
)";

constexpr const char* mint_check_help = R"(
Reads a program of SCALE, SPEED, ACCEL, DECEL, MOVEA, MOVER and GO as application note AN00115-001
prints it, and says for each GO which axes go where, and when; all in the user units that SCALE
makes, and in seconds. No module is needed. What is wrong comes as FILE:LINE:COLUMN: MESSAGE (exit
code 2); a move that no GO starts is a warning.

  SCALE = 1200             ' counts of a user unit (1 if there is no SCALE)
  SPEED = 250              ' DECEL is ACCEL if it is not given
  ACCEL = 1250
  MOVER = 200              ' loads a move by 200; MOVEA one to 200
  GO                       ' starts all that are loaded

SPEED = 1, 2 is of the axes 0 and 1; SPEED.2 = 1 of axis 2; SPEED[0,2] = 1, 2 of the listed ones,
SPEED[0,2] = 1; the same for them. GO[0,2] starts those together.

  tmclctl mint check exercise.mint
  tmclctl --json mint check exercise.mint
)";

}  // namespace

Form add_mint(Grammar& grammar) {
  const auto group = grammar.group("mint", "Movements in the words of Mint", mint_help);
  auto check = grammar.verb<verb::CheckMint>(
      group, "check", access::offline("it computes, and asks no module"),
      "What a Mint program would do, without doing it", mint_check_help, run);
  check.word("FILE", "The program", text(check->file));
  return group;
}

}  // namespace tmclctl

// mint check.
#include <fmt/format.h>

#include "path/path_source.hpp"
#include "print.hpp"
#include "text_problems.hpp"
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
  table.print(output.out);
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

}  // namespace

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

}  // namespace tmclctl

// mint run.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "path/drive.hpp"
#include "path/path_source.hpp"
#include "path/run_axes.hpp"
#include "print.hpp"
#include "safe_order.hpp"
#include "tmcl/plan/mint.hpp"
#include "tmcl/plan/ramp_choice.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace ap = tmcl::axis_parameter;
namespace json = boost::json;
namespace plan = tmcl::plan;
namespace mint = tmcl::plan::mint;

constexpr std::size_t most_bytes = 1 << 20;

struct MintAxis {
  std::string name;
  AxisUnits units;
  std::vector<plan::Setting> before{};  // the ramp's parameters, in the order of their first change
};
using MintAxes = std::map<unsigned, MintAxis>;

Attempt<MintAxes> axes_named(const std::vector<std::string>& choices, Target& target) {
  MintAxes axes;
  for (const auto& choice : choices) {
    const auto equals = choice.find('=');
    unsigned number = mint::most_axes;
    const auto [end, error] = std::from_chars(choice.data(), choice.data() + equals, number);
    const bool whole = error == std::errc{} && end == choice.data() + equals;
    if (!whole || number >= mint::most_axes) {
      return tl::unexpected(usage_failure(
          "unknown_axis",
          fmt::format("--axis {}: Mint's axes are 0 to {}", choice, mint::most_axes - 1)));
    }
    const auto name = choice.substr(equals + 1);
    auto units = target.units(name);
    if (!units) return tl::unexpected(units.error());
    if (units->model == nullptr || !units->module) {
      return tl::unexpected(path::impossible(
          "unknown_units", fmt::format("what the module of {} counts in is not known", name)));
    }
    if (!axes.emplace(number, MintAxis{name, *units}).second)
      return tl::unexpected(usage_failure("usage", fmt::format("axis {} is named twice", number)));
  }
  return axes;
}

bool is_moved(unsigned number, const mint::Program& program) {
  return std::ranges::any_of(program, [&](const mint::Statement& statement) {
    const bool moves =
        statement.keyword == mint::Keyword::movea || statement.keyword == mint::Keyword::mover;
    return moves && std::ranges::find(statement.values, number, &mint::AxisValue::axis) !=
                        statement.values.end();
  });
}

// Axis 0 is the first that there is, unless somebody says which is which.
Attempt<std::vector<std::string>> choices_for(const verb::RunMint& verb,
                                              const mint::Program& program, Context& context) {
  if (!verb.axes.empty()) return verb.axes;
  const auto rows = context.target.axes();
  if (!rows) return tl::unexpected(rows.error());
  std::vector<std::string> choices;
  for (unsigned number = 0; number < std::min<std::size_t>(rows->size(), mint::most_axes);
       ++number) {
    if (!is_moved(number, program)) continue;
    choices.push_back(fmt::format("{}={}", number, (*rows)[number].name));
    if (!context.output.json)
      context.output.out << fmt::format("axis {} is {}\n", number, (*rows)[number].name);
  }
  return choices;
}

Attempt<mint::Positions> positions_of(const MintAxes& axes, Target& target) {
  mint::Positions positions{};
  for (const auto& [number, axis] : axes) {
    const auto state = target.state(axis.name);
    if (!state) return tl::unexpected(state.error());
    if (state->moving)
      return tl::unexpected(path::impossible("moving", fmt::format("{} is moving", axis.name)));
    positions[number] = state->position.value;
  }
  return positions;
}

template <class T>
Attempt<T> good_in(const std::string& file, tl::expected<T, plan::TextProblems> result,
                   Output& output) {
  return std::move(result).map_error([&](const plan::TextProblems& problems) {
    return path::failure_from(file, problems, output);
  });
}

double target_of(const mint::Move& move) { return std::round(move.end * move.scale); }

Attempt<void> check_reach(const mint::Move& move, const MintAxis& axis) {
  const auto* row = find_parameter(axis.units.parameters(), ap::target_position);
  const double there = target_of(move);
  const bool reachable = row != nullptr && there >= row->minimum && there <= row->maximum;
  if (!reachable) {
    return tl::unexpected(path::impossible(
        "out_of_range", fmt::format("line {} moves {} to {:.0f} microsteps, where it cannot go",
                                    move.line, axis.name, there)));
  }
  const tmcl::Microsteps goal{static_cast<std::int32_t>(there)};
  const auto& soft = axis.units.limits;
  const auto too_far = soft ? beyond(*soft, goal, axis.units.limits_scale()) : std::nullopt;
  if (!too_far) return {};
  return tl::unexpected(path::impossible(
      "beyond_soft_limit",
      fmt::format("line {} moves {} too far: {}", move.line, axis.name, describe(*too_far))));
}

Attempt<plan::RampChoice> ramp_of(const mint::Move& move, const MintAxis& axis) {
  const auto& profile = *move.profile;
  const plan::RampRequest wish{{profile.speed * move.scale},
                               {profile.acceleration * move.scale},
                               {profile.deceleration * move.scale}};
  return plan::choose_ramp(*axis.units.model, wish, *axis.units.module)
      .map_error([&](const tmcl::RampOutOfReach& error) {
        return path::impossible("out_of_range", fmt::format("line {}: {} of {}: {}", move.line,
                                                            error.is_velocity ? "SPEED" : "ACCEL",
                                                            axis.name, describe(error.error)));
      });
}

/// Everything that can be known to be impossible before anything moves.
Attempt<void> check(const mint::DryRun& run, const MintAxes& axes, Output& output) {
  for (const auto& group : run.groups) {
    for (const auto& move : group.moves) {
      const auto axis = axes.find(move.axis);
      if (axis == axes.end()) {
        return tl::unexpected(usage_failure(
            "missing_axis",
            fmt::format("line {} moves axis {}: which axis is that?", move.line, move.axis),
            fmt::format("--axis {}=NAME", move.axis)));
      }
      if (const auto reach = check_reach(move, axis->second); !reach) return reach;
      if (!move.profile) continue;
      const auto ramp = ramp_of(move, axis->second);
      if (!ramp) return tl::unexpected(ramp.error());
      for (const auto& remark : ramp->remarks)
        output.err << fmt::format("tmclctl: warning: line {}: {}\n", move.line, remark);
    }
  }
  return {};
}

Attempt<void> remember(std::uint8_t parameter, MintAxis& axis, Target& target) {
  if (std::ranges::find(axis.before, parameter, &plan::Setting::parameter) != axis.before.end())
    return {};
  return target.get(axis.name, std::to_string(parameter)).map([&](const ParameterValue& value) {
    axis.before.push_back({parameter, value.value});
  });
}

Attempt<void> set_ramp(const mint::Move& move, MintAxis& axis, Target& target) {
  const auto ramp = ramp_of(move, axis);
  if (!ramp) return tl::unexpected(ramp.error());
  const auto settings = in_safe_order(ramp->settings, axis.name, target);
  if (!settings) return tl::unexpected(settings.error());
  for (const auto& setting : *settings) {
    if (const auto known = remember(setting.parameter, axis, target); !known) return known;
    const auto set = target.set(axis.name, std::to_string(setting.parameter), setting.value);
    if (!set) return tl::unexpected(set.error());
  }
  return {};
}

void restore(const MintAxes& axes, Context& context) {
  for (const auto& [number, axis] : axes) {
    const auto settings = in_safe_order(axis.before, axis.name, context.target);
    for (const auto& setting : settings.value_or(axis.before)) {
      const auto set =
          context.target.set(axis.name, std::to_string(setting.parameter), setting.value);
      if (set) continue;
      context.output.err << fmt::format("tmclctl: warning: parameter {} of {} was {} before: {}\n",
                                        setting.parameter, axis.name, setting.value,
                                        set.error().message);
    }
  }
}

Attempt<void> go(const mint::Group& group, MintAxes& axes, Context& context) {
  std::vector<std::string> names;
  std::vector<tmcl::Microsteps> positions;
  for (const auto& move : group.moves) {
    auto& axis = axes.at(move.axis);
    if (!move.profile) continue;
    if (auto set = set_ramp(move, axis, context.target); !set) return set;
    names.push_back(axis.name);
    positions.push_back({static_cast<std::int32_t>(target_of(move))});
  }
  return path::go_together(names, positions, fmt::format("at the GO of line {}", group.line),
                           context);
}

Attempt<void> pass(const mint::DryRun& run, MintAxes& axes, Context& context, json::array& groups) {
  for (const auto& group : run.groups) {
    const auto begin = context.host.now();
    if (auto gone = go(group, axes, context); !gone) return gone;
    const auto took = std::chrono::duration<double>(context.host.now() - begin).count();
    groups.push_back(
        json::object{{"line", group.line}, {"planned_s", group.duration}, {"took_s", took}});
    if (!context.output.json) {
      context.output.out << fmt::format("GO of line {}: {:.3f} s, planned {:.3f} s", group.line,
                                        took, group.duration)
                         << std::endl;
    }
  }
  return {};
}

}  // namespace

VerbResult run(const verb::RunMint& verb, Context& context) {
  const auto text = path::text_of(verb.file, most_bytes);
  if (!text) return tl::unexpected(text.error());
  const auto program = good_in(verb.file, mint::read(*text), context.output);
  if (!program) return tl::unexpected(program.error());
  const auto choices = choices_for(verb, *program, context);
  if (!choices) return tl::unexpected(choices.error());
  auto axes = axes_named(*choices, context.target);
  if (!axes) return tl::unexpected(axes.error());
  const auto start = positions_of(*axes, context.target);
  if (!start) return tl::unexpected(start.error());
  const auto run = good_in(verb.file, mint::dry_run(*program, *start), context.output);
  if (!run) return tl::unexpected(run.error());
  for (const auto& warning : run->warnings)
    context.output.err << "tmclctl: warning: " << describe(warning, verb.file) << '\n';
  if (const auto possible = check(*run, *axes, context.output); !possible)
    return tl::unexpected(possible.error());
  json::array groups;
  const auto passed = pass(*run, *axes, context, groups);
  restore(*axes, context);
  if (!passed) return tl::unexpected(passed.error());
  if (context.output.json)
    print_json({{"file", verb.file}, {"groups", std::move(groups)}}, context.output);
  return ExitCode::done;
}

}  // namespace tmclctl

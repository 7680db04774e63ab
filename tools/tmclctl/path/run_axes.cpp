#include "path/run_axes.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

namespace tmclctl::path {
namespace {

namespace ap = tmcl::axis_parameter;
namespace plan = tmcl::plan;

Attempt<std::int32_t> value_of(const std::string& axis, std::uint8_t parameter, Target& target) {
  return target.get(axis, std::to_string(parameter)).map([](const ParameterValue& value) {
    return value.value;
  });
}

Attempt<plan::PathAxisFacts> facts_of(const plan::PathChoice& choice, Target& target) {
  const auto units = target.units(choice.axis);
  if (!units) return tl::unexpected(units.error());
  const auto velocity = value_of(choice.axis, ap::max_velocity, target);
  if (!velocity) return tl::unexpected(velocity.error());
  const auto acceleration = value_of(choice.axis, ap::max_acceleration, target);
  if (!acceleration) return tl::unexpected(acceleration.error());
  const auto state = target.state(choice.axis);
  if (!state) return tl::unexpected(state.error());
  return plan::PathAxisFacts{choice,    units->model,  units->module,   units->scale, units->limits,
                             *velocity, *acceleration, state->position, state->moving};
}

// X is the axis X or x, unless something else was said.
std::vector<plan::PathChoice> with_namesakes(const Source& source,
                                             std::vector<plan::PathChoice> choices,
                                             Target& target) {
  for (const auto& of_file : source.path.axes) {
    if (std::ranges::find(choices, of_file, &plan::PathChoice::of_file) != choices.end()) continue;
    auto small = of_file;
    std::ranges::transform(small, small.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const auto& name : {of_file, small}) {
      if (!target.units(name)) continue;
      choices.push_back({of_file, name});
      break;
    }
  }
  return choices;
}

// What the command line can do about it.
Failure with_hint(const plan::PathObjection& objection, const Source& source,
                  const std::vector<plan::PathChoice>& choices) {
  auto failure = failure_from(objection);
  if (objection.name == "unknown_unit") {
    failure.hint =
        "--per-turn says how many units of the file a turn of the motor is; tmcld.toml can, too";
  }
  if (objection.name != "missing_axis") return failure;
  for (const auto& of_file : source.path.axes) {
    if (std::ranges::find(choices, of_file, &plan::PathChoice::of_file) != choices.end()) continue;
    failure.hint = fmt::format("--axis {}=NAME", of_file);
    break;
  }
  return failure;
}

}  // namespace

Failure impossible(std::string name, std::string message, std::string hint) {
  auto failure = usage_failure(std::move(name), std::move(message), std::move(hint));
  failure.exit = exit_for_objection(failure.name);
  failure.outcome = tmcl::Outcome::not_sent;
  return failure;
}

Attempt<std::vector<plan::PathAxis>> read_axes(const Source& source,
                                               const std::vector<plan::PathChoice>& said,
                                               const plan::PathRequest& request, Target& target) {
  const auto choices = with_namesakes(source, said, target);
  const auto ordered = plan::in_order(source, choices);
  if (!ordered) return tl::unexpected(with_hint(ordered.error(), source, choices));
  std::vector<plan::PathAxis> axes;
  for (const auto& choice : *ordered) {
    const auto facts = facts_of(choice, target);
    if (!facts) return tl::unexpected(facts.error());
    auto axis = plan::path_axis(source, *facts, request);
    if (!axis) return tl::unexpected(with_hint(axis.error(), source, choices));
    axes.push_back(std::move(*axis));
  }
  return axes;
}

std::vector<std::string> names_of(const std::vector<plan::PathAxis>& axes) {
  std::vector<std::string> names;
  for (const auto& axis : axes) names.push_back(axis.choice.axis);
  return names;
}

}  // namespace tmclctl::path

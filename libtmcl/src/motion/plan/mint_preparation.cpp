#include "tmcl/plan/mint_preparation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"
#include "tmcl/plan/ramp_choice.hpp"

namespace tmcl::plan {
namespace {

namespace ap = axis_parameter;

PathObjection mint_objection(std::string name, std::string message) {
  return {std::move(name), std::move(message), {}, {}};
}

template <class T>
PathResult<T> as_result(tl::expected<T, TextProblems> read) {
  return std::move(read).map_error([](TextProblems problems) {
    return PathObjection{"bad_program", "the program cannot be run", std::move(problems), {}};
  });
}

PathResult<Microsteps> target_of(const mint::Move& move, const MintAxis& moved) {
  const auto& axis = moved.units;
  const double there = std::round(move.end * move.scale * moved.microsteps_per_count);
  const auto* row = find_parameter(axis.parameters(), ap::target_position);
  if (row == nullptr || !(there >= row->minimum && there <= row->maximum)) {
    return tl::unexpected(mint_objection(
        "out_of_range", fmt::format("line {} moves {} to {:.0f} microsteps, where it cannot go",
                                    move.line, axis.axis, there)));
  }
  const Microsteps target{static_cast<std::int32_t>(there)};
  const auto too_far =
      axis.limits ? beyond(*axis.limits, target, axis.limits_scale()) : std::nullopt;
  if (!too_far) return target;
  return tl::unexpected(mint_objection(
      "beyond_soft_limit",
      fmt::format("line {} moves {} too far: {}", move.line, axis.axis, describe(*too_far))));
}

/// In user units and seconds, which have no names in a program.
RampRequest wish_of(const Profile& profile, double microsteps_per_unit) {
  const auto in_microsteps = [&](double value) { return value * microsteps_per_unit; };
  RampRequest wish{{in_microsteps(profile.speed)},
                   {in_microsteps(profile.acceleration)},
                   {in_microsteps(profile.deceleration)}};
  const WishUnit user{1 / microsteps_per_unit, ""};
  wish.said_in = {user, user, user, user};
  return wish;
}

/// The value that is out of reach, as the program has it.
struct Culprit {
  std::string_view keyword;
  double value;
};
Culprit culprit_of(const OutOfReach& error, const RampRequest& wish, const Profile& profile) {
  if (error.is_velocity()) return {"SPEED", profile.speed};
  const auto off = [&](PulsesPerSecond2 wished) { return std::abs(error.wished - wished.value); };
  if (off(wish.deceleration) < off(wish.acceleration)) return {"DECEL", profile.deceleration};
  return {"ACCEL", profile.acceleration};
}

/// What the registers can hold is a number of microsteps.
std::string hint_of_microsteps(const mint::Move& move, const MintAxis& moved) {
  const auto& axis = moved.units;
  if (!axis.scale) return {};
  const double scale = move.scale * moved.microsteps_per_count;
  double found = 1;
  auto hint = hint_of_resolution(axis.scale->steps.resolution, [&](double share) {
    found = share;
    return choose_ramp(*axis.model, wish_of(*move.profile, scale * share), *axis.module)
        .has_value();
  });
  if (!hint.empty() && !moved.counts_encoder)
    hint += "; SCALE is " + plain_number(move.scale * found) + " then";
  return hint;
}

PathResult<RampChoice> ramp_of(const mint::Move& move, const MintAxis& moved) {
  const auto& axis = moved.units;
  const auto wish = wish_of(*move.profile, move.scale * moved.microsteps_per_count);
  return choose_ramp(*axis.model, wish, *axis.module).map_error([&](const OutOfReach& error) {
    const auto culprit = culprit_of(error, wish, *move.profile);
    auto told = in_unit(error, wish.said_in.velocity);
    told.wished = culprit.value;
    auto objection =
        mint_objection("out_of_range", fmt::format("line {}: {} of {}: {}", move.line,
                                                   culprit.keyword, axis.axis, describe(told)));
    if (error.wished > error.nearest) objection.hint = hint_of_microsteps(move, moved);
    return objection;
  });
}

PathResult<std::size_t> index_of(const mint::Move& move, const std::vector<MintAxis>& axes) {
  const auto axis = std::ranges::find(axes, move.axis, &MintAxis::number);
  if (axis == axes.end()) {
    auto objection = mint_objection(
        "missing_axis",
        fmt::format("line {} moves axis {}: which axis is that?", move.line, move.axis));
    objection.file_axis = std::to_string(move.axis);
    return tl::unexpected(std::move(objection));
  }
  if (axis->units.model == nullptr || !axis->units.module) {
    return tl::unexpected(mint_objection(
        "unknown_units",
        fmt::format("what the module of {} counts in is not known", axis->units.axis)));
  }
  return static_cast<std::size_t>(axis - axes.begin());
}

/// Nothing for an axis that stands there already.
PathResult<std::optional<MintDriveMove>> drive_move_of(const mint::Move& move,
                                                       const std::vector<MintAxis>& axes,
                                                       std::vector<std::string>& remarks) {
  using Made = std::optional<MintDriveMove>;
  const auto axis = index_of(move, axes);
  if (!axis) return tl::unexpected(axis.error());
  const auto target = target_of(move, axes[*axis]);
  if (!target) return tl::unexpected(target.error());
  if (!move.profile) return Made{};
  return ramp_of(move, axes[*axis]).map([&](RampChoice ramp) {
    for (const auto& remark : ramp.remarks)
      remarks.push_back(fmt::format("line {}: {}", move.line, remark));
    return Made({*axis, *target, std::move(ramp.settings)});
  });
}

}  // namespace

PathResult<mint::Program> read_mint(std::string_view text) { return as_result(mint::read(text)); }

std::set<unsigned> axes_moved_by(const mint::Program& program) {
  std::set<unsigned> moved;
  for (const auto& statement : program) {
    const bool moves =
        statement.keyword == mint::Keyword::movea || statement.keyword == mint::Keyword::mover;
    for (const auto& value : statement.values)
      if (moves) moved.insert(value.axis);
  }
  return moved;
}

std::size_t MintPlan::bytes() const {
  constexpr auto of_group = sizeof(MintDriveGroup) + sizeof(Duration);  // and how long it took
  auto bytes = sizeof *this + groups.capacity() * of_group;
  for (const auto& group : groups) {
    bytes += group.moves.capacity() * sizeof(MintDriveMove);
    for (const auto& move : group.moves) bytes += move.ramp.capacity() * sizeof(Setting);
  }
  for (const auto& remark : remarks) bytes += sizeof remark + remark.capacity();
  return bytes;
}

PathResult<MintPlan> plan_mint(const mint::Program& program, const std::vector<MintAxis>& axes) {
  mint::Positions start{};
  for (const auto& axis : axes)
    start.at(axis.number) = axis.position.value / axis.microsteps_per_count;
  const auto run = as_result(mint::dry_run(program, start));
  if (!run) return tl::unexpected(run.error());
  MintPlan plan;
  for (const auto& warning : run->warnings)
    plan.remarks.push_back(fmt::format("line {}: {}", warning.line, warning.message));
  for (const auto& group : run->groups) {
    MintDriveGroup drive{group.line, group.duration, {}};
    for (const auto& move : group.moves) {
      auto made = drive_move_of(move, axes, plan.remarks);
      if (!made) return tl::unexpected(std::move(made.error()));
      if (*made) drive.moves.push_back(std::move(**made));
    }
    plan.groups.push_back(std::move(drive));
  }
  return plan;
}

}  // namespace tmcl::plan

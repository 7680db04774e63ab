// Several axes on a straight line.
#include "api/audit.hpp"
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/views.hpp"
#include "gateway/journey/line.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

using tmcl::Duration;
using tmcl::seconds;

Result<std::optional<Duration>> duration_of(std::optional<double> time_s) {
  constexpr double longest_s = 86'400;
  if (!time_s) return std::nullopt;
  const std::chrono::duration<double> time(*time_s);
  if (time.count() > 0 && time.count() <= longest_s)
    return std::chrono::duration_cast<Duration>(time);
  return tl::unexpected(param_error<&line::Move::time_s>(
      "out_of_range", "'time_s' must be greater than 0 and at most 86400"));
}

RawOrQuantity velocity_in(const line::Move& params) {
  return raw_or_quantity<&line::Move::velocity_pps, &line::Move::velocity>(params);
}
RawOrQuantity acceleration_in(const line::Move& params) {
  return raw_or_quantity<&line::Move::acceleration_pps2, &line::Move::acceleration>(params);
}

using Axes = std::vector<std::shared_ptr<GatewayAxis>>;

/// One number is meant for all of them; a text has its unit.
std::optional<Error> check_same_unit(const line::Move& params, const Axes& axes) {
  for (const auto& said : {velocity_in(params), acceleration_in(params)}) {
    if (!said.amount || std::holds_alternative<std::string>(said.amount->said)) continue;
    for (const auto& axis : axes) {
      if (axis->unit() == axes.front()->unit()) continue;
      const auto unit_of = [](const GatewayAxis& one) {
        return "axis '" + one.name() + "' " +
               (one.unit().empty() ? "has no unit of its own" : "is in " + one.unit());
      };
      return param_error("bad_argument", said.amount_name,
                         unit_of(*axes.front()) + " and " + unit_of(*axis),
                         "give 'velocity_pps' and 'acceleration_pps2'");
    }
  }
  return std::nullopt;
}

/// Where each axis is to go.
Result<std::vector<RawOrQuantity>> positions_of(const line::Move& params) {
  constexpr auto plain = api::name_of<&line::Move::positions_microsteps>();
  constexpr auto amount = api::name_of<&line::Move::positions>();
  if (params.positions.has_value() == params.positions_microsteps.has_value()) {
    return tl::unexpected(param_error(
        "bad_argument", plain, "give one of 'positions_microsteps' and 'positions', and not both"));
  }
  std::vector<RawOrQuantity> all;
  if (params.positions) {
    for (const auto& position : *params.positions) all.push_back({plain, amount, {}, position});
  } else {
    for (const auto place : *params.positions_microsteps) all.push_back({plain, amount, place, {}});
  }
  return all;
}

Result<Axes> axes_in(const Call& call, const line::Move& params, std::size_t positions) {
  if (params.axes.empty()) {
    return tl::unexpected(
        param_error<&line::Move::axes>("bad_argument", "a line is of one axis at least"));
  }
  auto axes = axes_of(call, params.axes);
  if (!axes) return axes;
  if (axes->size() != positions || axes->size() != params.axes.size()) {
    const auto param = params.positions ? api::name_of<&line::Move::positions>()
                                        : api::name_of<&line::Move::positions_microsteps>();
    return tl::unexpected(param_error(
        "bad_argument", param, "there must be one position for each axis, and each axis once"));
  }
  if (auto complaint = check_same_unit(params, *axes)) return tl::unexpected(std::move(*complaint));
  return axes;
}

Task<LineMember> member_of(const line::Move& params, std::shared_ptr<GatewayAxis> axis,
                           RawOrQuantity position) {
  co_await must(axis->be_ready(), *axis);
  const auto* row = find_parameter(axis->parameters(), tmcl::axis_parameter::target_position);
  const auto target = co_await must(length_of(*axis, std::move(position), row));
  const auto velocity = co_await must(velocity_limit_of(*axis, velocity_in(params)));
  const auto acceleration = co_await must(acceleration_limit_of(*axis, acceleration_in(params)));
  co_return LineMember{axis, target.microsteps, velocity, acceleration};
}

Task<std::vector<LineMember>> members_of(const Call& call, const line::Move& params) {
  const auto positions = co_await must(positions_of(params));
  const auto axes = co_await must(axes_in(call, params, positions.size()));
  std::vector<LineMember> members;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    auto member = co_await must(member_of(params, axes[i], positions[i]));
    members.push_back(std::move(member));
  }
  co_return members;
}

boost::asio::awaitable<line::LineAxis> to_result(const LineMember& member, Duration arrival) {
  line::LineAxis axis{member.axis->name(), member.target.value};
  const auto& unit = member.axis->unit();
  const auto scale = co_await member.axis->scale();
  if (scale && *scale && !unit.empty()) axis.target = to_user(member.target, **scale).value;
  axis.unit = if_any(unit);
  axis.predicted_s = seconds(arrival);
  co_return axis;
}

std::vector<std::string> warnings_of(const std::vector<LineMember>& members,
                                     const tmcl::plan::Line& plan) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < members.size(); ++i) {
    // It is where it is to be.
    if (plan.axes[i].twin.motion().position == members[i].target) continue;
    for (const auto& warning : members[i].axis->warnings_of(plan.axes[i].twin))
      warnings.push_back(members[i].axis->name() + ": " + warning);
  }
  return warnings;
}

}  // namespace

Answer<line::Move> move_line(Call& call, const line::Move& params) {
  auto members = co_await must(members_of(call, params));
  const auto duration = co_await must(duration_of(params.time_s));
  begin_journey(call);
  LineOrder order{
      members,           duration, call.permit, call.deadline(params), &call.gateway->planner,
      audit_of_end(call)};
  call.goes_on = true;
  const auto started = co_await must(start_line(std::move(order)));
  const auto& plan = started.plan;
  line::StartedLine result{{},
                           seconds(plan.duration),
                           seconds(plan.spread),
                           plan.deviation,
                           started.one_command,
                           seconds(started.predicted_skew),
                           seconds(started.skew),
                           warnings_of(members, plan)};
  if (!started.journal_failure.empty())
    result.warnings->push_back(journal_warning(started.journal_failure));
  for (std::size_t i = 0; i < members.size(); ++i) {
    auto axis = co_await to_result(members[i], plan.axes[i].arrival);
    result.axes.push_back(std::move(axis));
  }
  co_return result;
}

}  // namespace tmcld::handlers

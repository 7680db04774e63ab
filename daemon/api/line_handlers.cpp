// Several axes on a straight line.
#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "gateway/line.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
using tmcl::Duration;
using tmcl::seconds;

Lookup<std::optional<Duration>> duration_of(const Call& call) {
  constexpr double longest_s = 86'400;
  if (!call.params.has("time_s")) return std::nullopt;
  const std::chrono::duration<double> time(call.params.number("time_s"));
  if (time.count() > 0 && time.count() <= longest_s)
    return std::chrono::duration_cast<Duration>(time);
  return tl::unexpected(
      param_error("out_of_range", "time_s", "'time_s' must be greater than 0 and at most 86400"));
}

/// One number is meant for all of them; a text has its unit.
std::optional<RpcError> check_same_unit(const Call& call,
                                        const std::vector<std::shared_ptr<GatewayAxis>>& axes) {
  for (const auto* param : {"velocity", "acceleration"}) {
    if (!call.params.has(param) || call.params.is_text(param)) continue;
    for (const auto& axis : axes) {
      if (axis->unit() == axes.front()->unit()) continue;
      const auto said = [](const GatewayAxis& one) {
        return "axis '" + one.name() + "' " +
               (one.unit().empty() ? "has no unit of its own" : "is in " + one.unit());
      };
      return param_error("bad_argument", param, said(*axes.front()) + " and " + said(*axis),
                         "give 'velocity_pps' and 'acceleration_pps2'");
    }
  }
  return std::nullopt;
}

boost::asio::awaitable<Lookup<std::vector<LineMember>>> members_of(const Call& call) {
  const bool in_unit = call.params.has("positions");
  const auto* list = in_unit ? "positions" : "positions_microsteps";
  if (in_unit == call.params.has("positions_microsteps")) {
    co_return tl::unexpected(
        param_error("bad_argument", "positions_microsteps",
                    "give one of 'positions_microsteps' and 'positions', and not both"));
  }
  const auto axes = axes_of(call);
  if (!axes) co_return tl::unexpected(axes.error());
  const auto count = call.params.count(list);
  if (axes->size() != count || axes->size() != call.params.count("axes")) {
    co_return tl::unexpected(param_error(
        "bad_argument", list, "there must be one position for each axis, and each axis once"));
  }
  if (auto complaint = check_same_unit(call, *axes))
    co_return tl::unexpected(std::move(*complaint));
  std::vector<LineMember> members;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& axis = (*axes)[i];
    const auto ready = co_await axis->be_ready();
    if (!ready) co_return tl::unexpected(call_error(ready.error(), axis->name()));
    const auto target = co_await position_for(call, *axis, list, i);
    if (!target) co_return tl::unexpected(target.error());
    const auto limits = co_await motion_limits_of(call, *axis);
    if (!limits) co_return tl::unexpected(limits.error());
    members.push_back({axis, *target, limits->velocity, limits->acceleration});
  }
  co_return members;
}

boost::asio::awaitable<json::object> to_json(const LineMember& member, Duration arrival) {
  json::object axis{{"axis", member.axis->name()}, {"target_microsteps", member.target.value}};
  const auto& unit = member.axis->unit();
  const auto scale = co_await member.axis->scale();
  const bool has_unit = scale && *scale && !unit.empty();
  axis["target"] =
      has_unit ? json::value(tmcl::to_user(member.target, **scale).value) : json::value(nullptr);
  axis["unit"] = unit.empty() ? json::value(nullptr) : json::value(unit);
  axis["predicted_s"] = seconds(arrival);
  co_return axis;
}

json::object to_json(const StartedLine& line, json::array axes) {
  return {{"axes", std::move(axes)},
          {"predicted_s", seconds(line.plan.duration)},
          {"spread_s", seconds(line.plan.spread)},
          {"deviation", line.plan.deviation},
          {"one_command", line.one_command},
          {"predicted_skew_s", seconds(line.predicted_skew)},
          {"skew_s", seconds(line.skew)}};
}

}  // namespace

Answer move_line(Call& call) {
  auto members = co_await members_of(call);
  if (!members) co_return tl::unexpected(std::move(members.error()));
  const auto duration = duration_of(call);
  if (!duration) co_return tl::unexpected(duration.error());
  LineOrder order{*members, *duration, call.permit, call.deadline(), &call.gateway->planner};
  const auto started = co_await start_line(std::move(order));
  if (!started) co_return tl::unexpected(call_error(started.error().error, started.error().axis));
  json::array axes;
  for (std::size_t i = 0; i < members->size(); ++i) {
    auto axis = co_await to_json((*members)[i], started->plan.axes[i].arrival);
    axes.push_back(std::move(axis));
  }
  co_return to_json(*started, std::move(axes));
}

}  // namespace tmcld::handlers

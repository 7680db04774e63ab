// Several axes on a straight line.
#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "gateway/line.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;
using tmcl::Duration;

double seconds(Duration time) { return std::chrono::duration<double>(time).count(); }

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
  std::vector<LineMember> members;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& axis = (*axes)[i];
    const auto ready = co_await axis->be_ready();
    if (!ready) co_return tl::unexpected(call_error(ready.error(), axis->name()));
    const auto target = co_await position_for(call, *axis, list, i);
    if (!target) co_return tl::unexpected(target.error());
    members.push_back({axis, *target});
  }
  co_return members;
}

json::object to_json(const StartedLine& line, const std::vector<LineMember>& members) {
  json::array axes;
  for (std::size_t i = 0; i < members.size(); ++i) {
    axes.push_back(json::object{{"axis", members[i].axis->name()},
                                {"target_microsteps", members[i].target.value},
                                {"predicted_s", seconds(line.plan.axes[i].arrival)}});
  }
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
  const auto started = co_await start_line(*members, call.deadline());
  if (!started) co_return tl::unexpected(call_error(started.error().error, started.error().axis));
  co_return to_json(*started, *members);
}

}  // namespace tmcld::handlers

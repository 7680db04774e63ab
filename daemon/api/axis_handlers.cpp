#include <fmt/format.h>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/views.hpp"
#include "gateway/journey/approach.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/seconds.hpp"

namespace tmcld::handlers {
namespace {

namespace ap = tmcl::axis_parameter;

boost::asio::awaitable<axis::StartedMove> to_result(GatewayAxis& axis, StartedMove started,
                                                    const tmcl::UserScale* scale) {
  auto target = co_await in_unit(axis, started.target, scale);
  axis::StartedMove result{started.target.value, std::move(target.unit), target.number};
  if (started.predicted) result.predicted_s = tmcl::seconds(*started.predicted);
  result.warnings = std::move(started.warnings);
  co_return result;
}

GatewayAxis::Awaitable<StartedMove> approach_by(ReadyToMove ready, Length distance, bool predict) {
  const auto target = co_await ready.axis->end_of(distance, ready.moves);
  if (!target) co_return tl::unexpected(target.error());
  ApproachOrder order{ready.axis, ready.moves, *target, predict};
  auto started = co_await approach(std::move(order));
  co_return started;
}

using Warnings = std::vector<std::string>;

/// It has arrived by the counter of its module, which knows nothing of the motor.
boost::asio::awaitable<Error> faulty_arrival(GatewayAxis& axis, const RestingPosition& arrived) {
  const auto place = co_await place_of(axis, arrived.position);
  const auto where = place.position
                         ? tmcl::plain_number(*place.position, 6) + ' ' + place.unit.value_or("")
                         : std::to_string(place.position_microsteps);
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.bus = axis.bus().name();
  error.message = "axis '" + axis.name() + "' is at " + where +
                  " by its counter, but its driver reports: " + words_for(arrived.faults);
  error.hint =
      "the motor may not have moved: check the motor, its cable and the supply; "
      "'tmclctl errors " +
      axis.name() + "' shows what is wrong now";
  auto result = call_error(error, axis.name());
  result.name = tmcl::client::error_name::driver_fault;
  boost::json::array faults;
  for (const auto fault : arrived.faults) faults.emplace_back(fault);
  result.subject["faults"] = std::move(faults);
  co_return result;
}

boost::asio::awaitable<Error> out_of_position(GatewayAxis& axis, const RestingPosition& arrived) {
  const auto place = co_await place_of(axis, arrived.position);
  const auto unit = place.unit.value_or("microsteps");
  const double there = place.position.value_or(place.position_microsteps);
  const auto off = tmcl::plain_number(*arrived.out_of_position, 6) + ' ' + unit;
  tmcl::Error error;
  error.code = tmcl::Errc::move_interrupted;
  error.outcome = tmcl::Outcome::done;
  error.bus = axis.bus().name();
  error.message = "axis '" + axis.name() + "' is at " + tmcl::plain_number(there, 6) + ' ' + unit +
                  " by its counter, and by its encoder " + off +
                  " from there: 'in_position' allows " +
                  tmcl::plain_number(axis.in_position()->window, 6);
  error.hint = "the load may stick, or the motor has lost steps: 'tmclctl home " + axis.name() +
               "' tells; or the encoder counts from another zero";
  auto result = call_error(error, axis.name());
  result.name = tmcl::client::error_name::not_in_position;
  result.subject["off"] = *arrived.out_of_position;
  co_return result;
}

}  // namespace

Answer<axis::List> list_axes(Call& call, const axis::List& params) {
  axis::Axes result;
  const bool all = params.all.value_or(false);
  for (const auto& axis : all ? call.gateway->all_axes() : call.gateway->axes())
    result.axes.push_back(view_of(*axis));
  co_return result;
}

Answer<axis::MoveTo> move_to(Call& call, const axis::MoveTo& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto* row = find_parameter(axis.parameters(), ap::target_position);
  const auto said =
      raw_or_quantity<&axis::MoveTo::position_microsteps, &axis::MoveTo::position>(params);
  const auto target = co_await must(length_of(axis, said, row));
  const auto predict = params.predict.value_or(true);
  ApproachOrder order{ready.axis, ready.moves, target.length(), predict};
  auto moving = axis.approach() ? approach(std::move(order))
                                : axis.move_to(target.length(), predict, ready.moves);
  const auto moved = co_await must(std::move(moving), axis);
  auto result = co_await to_result(axis, moved, target.known_scale());
  co_return result;
}

Answer<axis::MoveBy> move_by(Call& call, const axis::MoveBy& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto said =
      raw_or_quantity<&axis::MoveBy::distance_microsteps, &axis::MoveBy::distance>(params);
  const auto distance = co_await must(distance_of(axis, said));
  const auto predict = params.predict.value_or(true);
  auto moving = axis.approach() ? approach_by(ready, distance.length(), predict)
                                : axis.move_by(distance.length(), predict, ready.moves);
  const auto moved = co_await must(std::move(moving), axis);
  auto result = co_await to_result(axis, moved, distance.known_scale());
  co_return result;
}

Answer<axis::Rotate> rotate(Call& call, const axis::Rotate& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto said =
      raw_or_quantity<&axis::Rotate::velocity_internal, &axis::Rotate::velocity>(params);
  const auto velocity = co_await must(velocity_of(axis, said));
  auto movement = ready.moves;
  movement.permit.unattended = params.unattended.value_or(false);
  co_await must(axis.rotate({velocity.value}, std::move(movement)), axis);
  const auto& journal = axis.bus().journal();
  const auto unkept = journal && velocity.value != 0 ? journal->failure() : std::string();
  auto told = co_await velocity_in_unit(axis, velocity);
  axis::Turning result{velocity.value, std::move(told.unit), told.number, Warnings{}};
  const auto greatest = co_await axis.get(ap::max_velocity, {});
  if (greatest && std::abs(std::int64_t{velocity.value}) > *greatest)
    result.warnings->emplace_back("it turns faster than max_velocity, which holds for positions");
  if (!unkept.empty()) result.warnings->push_back(journal_warning(unkept));
  co_return result;
}

Answer<axis::Stop> stop(Call& call, const axis::Stop& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const StopInProgress in_progress(call.gateway);
  co_await must(axis->stop(StopCause::client, call.permit.client), *axis);
  co_return Nothing{};
}

Answer<axis::Wait> wait(Call& call, const axis::Wait& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->be_ready(), *axis);
  tmcl::WaitOptions options;
  options.timeout = call.timeout_left(params.timeout_ms);
  if (params.target_microsteps) options.goal = tmcl::Microsteps{*params.target_microsteps};
  // Nothing else ends a wait without a timeout.
  Objection objection = [peer = call.peer]() -> std::optional<tmcl::Error> {
    if (!peer->is_gone()) return std::nullopt;
    return tmcl::bad_argument("the client is gone");
  };
  const auto arrived = co_await must(axis->wait(options, std::move(objection)), *axis);
  if (keeps_from_moving(arrived.faults)) {
    auto fault = co_await faulty_arrival(*axis, arrived);
    co_return tl::unexpected(std::move(fault));
  }
  if (arrived.out_of_position) {
    auto off = co_await out_of_position(*axis, arrived);
    co_return tl::unexpected(std::move(off));
  }
  auto place = co_await place_of(*axis, arrived.position);
  auto warnings = arrived.warnings;
  if (!arrived.faults.empty()) warnings.push_back(words_for(arrived.faults));
  if (!arrived.unproven.empty())
    warnings.push_back("its driver reports: " + words_for(arrived.unproven) +
                       "; that is certain only when it does so while the axis turns slowly");
  co_return axis::Standing{std::move(place), std::move(warnings)};
}

Answer<axis::GetUnits> get_units(Call& call, const axis::GetUnits& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->be_ready(), *axis);
  const auto module = co_await must(axis->module_units(), *axis);
  const auto scale = co_await must(axis->scale(), *axis);
  co_return view_of(*axis, module, scale);
}

Answer<axis::GetState> get_state(Call& call, const axis::GetState& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const std::chrono::milliseconds max_age(params.max_age_ms.value_or(0));
  const auto reading = co_await must(axis->read_state(max_age, call.permit.client), *axis);
  co_return view_of(*axis, reading);
}

}  // namespace tmcld::handlers

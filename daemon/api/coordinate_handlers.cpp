// Positions that modules remember by a number.
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/module_choice.hpp"
#include "api/quantity.hpp"
#include "api/views.hpp"

namespace tmcld::handlers {
namespace {

using boost::asio::awaitable;
using tmcl::Microsteps;
template <class T>
using Verb = tmcl::Script<tmcl::Result<T>>;

Task<axis::Place> position_from(Call& call, const coordinate::OnCoordinate& params,
                                Verb<Microsteps> (*verb)(tmcl::AxisAddress, std::uint8_t)) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto script = verb(axis->address(), params.number);
  const auto place = co_await must(axis->perform(std::move(script), in_time(call, params)), *axis);
  auto result = co_await place_of(*axis, place);
  co_return result;
}

Task<Nothing> act_on_eeprom(Call& call, const coordinate::InEeprom& params,
                            Verb<void> (*verb)(tmcl::ModuleAddress, std::optional<std::uint8_t>)) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto script = verb(axis->address().module, params.number);
  co_await must(axis->perform(std::move(script), in_time(call, params)), *axis);
  co_return Nothing{};
}

/// Each of these motors may go to its coordinate.
Task<void> check_limits(const Call& call, const coordinate::Start& params,
                        const ModuleChoice& module, tmcl::MotorMask motors) {
  for (const auto& axis : call.gateway->axes()) {
    const auto [address, motor] = axis->address();
    const bool starts = &axis->bus() == module.bus.get() && address == module.address &&
                        motor < 8 && (unsigned{motors.bits} >> motor & 1U) != 0;
    if (!starts) continue;
    co_await must(axis->check_coordinate(params.number, in_time(call, params)), *axis);
  }
}

}  // namespace

Answer<coordinate::Get> get_coordinate(Call& call, const coordinate::Get& params) {
  return position_from(call, params, tmcl::verbs::coordinate);
}
Answer<coordinate::Capture> capture_coordinate(Call& call, const coordinate::Capture& params) {
  return position_from(call, params, tmcl::verbs::capture_coordinate);
}

Answer<coordinate::Set> set_coordinate(Call& call, const coordinate::Set& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  const auto said =
      raw_or_quantity<&coordinate::Set::position_microsteps, &coordinate::Set::position>(params);
  const auto position = co_await must(length_of(*axis, said, nullptr));
  auto script = tmcl::verbs::set_coordinate(axis->address(), params.number, position.microsteps);
  co_await must(axis->perform(std::move(script), in_time(call, params)), *axis);
  co_return Nothing{};
}

Answer<coordinate::Move> move_to_coordinate(Call& call, const coordinate::Move& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  co_await must(axis.move_to_coordinate(params.number, ready.moves), axis);
  co_return Nothing{};
}

Answer<coordinate::Start> start_coordinate(Call& call, const coordinate::Start& params) {
  const auto module = co_await must(module_of(call, params));
  const tmcl::MotorMask motors{static_cast<std::uint8_t>(mask_of(params.motors))};
  // The module reads the coordinates again: they stay what they are from the check to the move.
  const auto hold = module.bus->motors().coordinates().holds.set(module.address);
  co_await must(run_on(module, call, module.bus->gate().hold_still(module.address)));
  co_await must(check_limits(call, params, module, motors));
  const auto together = params.interpolated.value_or(false) ? tmcl::Together::interpolated
                                                            : tmcl::Together::each_for_itself;
  auto script =
      tmcl::verbs::move_motors_to_coordinate(module.address, motors, together, params.number);
  auto started = co_await act_on(call, module, std::move(script));
  co_return started;
}

Answer<coordinate::Store> store_coordinates(Call& call, const coordinate::Store& params) {
  return act_on_eeprom(call, params, tmcl::verbs::store_coordinates);
}
Answer<coordinate::Load> load_coordinates(Call& call, const coordinate::Load& params) {
  return act_on_eeprom(call, params, tmcl::verbs::load_coordinates);
}

}  // namespace tmcld::handlers

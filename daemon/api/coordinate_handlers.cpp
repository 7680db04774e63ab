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

awaitable<Lookup<axis::Place>> position_from(Call& call, const coordinate::OnCoordinate& params,
                                             Verb<Microsteps> (*verb)(tmcl::AxisAddress,
                                                                      std::uint8_t)) {
  const auto axis = axis_of(call, params.axis);
  if (!axis) co_return tl::unexpected(axis.error());
  auto script = verb((*axis)->address(), params.number);
  const auto place = co_await (*axis)->perform(std::move(script), in_time(call, params));
  if (!place) co_return tl::unexpected(call_error(place.error(), (*axis)->name()));
  auto result = co_await place_of(**axis, *place);
  co_return result;
}

awaitable<Lookup<Nothing>> act_on_eeprom(Call& call, const coordinate::InEeprom& params,
                                         Verb<void> (*verb)(tmcl::ModuleAddress,
                                                            std::optional<std::uint8_t>)) {
  const auto axis = axis_of(call, params.axis);
  if (!axis) co_return tl::unexpected(axis.error());
  auto script = verb((*axis)->address().module, params.number);
  const auto done = co_await (*axis)->perform(std::move(script), in_time(call, params));
  co_return nothing_or(done, **axis);
}

/// Why one of these motors must not go to its coordinate.
awaitable<std::optional<RpcError>> check_limits(const Call& call, const coordinate::Start& params,
                                                const ModuleChoice& module,
                                                tmcl::MotorMask motors) {
  for (const auto& axis : call.gateway->axes()) {
    const auto [address, motor] = axis->address();
    const bool starts = &axis->bus() == module.bus.get() && address == module.address &&
                        motor < 8 && (unsigned{motors.bits} >> motor & 1U) != 0;
    if (!starts) continue;
    const auto checked = co_await axis->check_coordinate(params.number, in_time(call, params));
    if (!checked) co_return call_error(checked.error(), axis->name());
  }
  co_return std::nullopt;
}

}  // namespace

Answer<coordinate::Get> get_coordinate(Call& call, const coordinate::Get& params) {
  return position_from(call, params, tmcl::verbs::coordinate);
}
Answer<coordinate::Capture> capture_coordinate(Call& call, const coordinate::Capture& params) {
  return position_from(call, params, tmcl::verbs::capture_coordinate);
}

Answer<coordinate::Set> set_coordinate(Call& call, const coordinate::Set& params) {
  const auto axis = axis_of(call, params.axis);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto said =
      either<&coordinate::Set::position_microsteps, &coordinate::Set::position>(params);
  const auto position = co_await length_of(**axis, said, nullptr);
  if (!position) co_return tl::unexpected(position.error());
  auto script =
      tmcl::verbs::set_coordinate((*axis)->address(), params.number, position->microsteps);
  const auto done = co_await (*axis)->perform(std::move(script), in_time(call, params));
  co_return nothing_or(done, **axis);
}

Answer<coordinate::Move> move_to_coordinate(Call& call, const coordinate::Move& params) {
  const auto ready = co_await ready_to_move(call, params);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto done = co_await axis.move_to_coordinate(params.number, ready->moves);
  co_return nothing_or(done, axis);
}

Answer<coordinate::Start> start_coordinate(Call& call, const coordinate::Start& params) {
  const auto module = module_of(call, params);
  if (!module) co_return tl::unexpected(module.error());
  const tmcl::MotorMask motors{static_cast<std::uint8_t>(mask_of(params.motors))};
  // The module reads the coordinates again: they stay what they are from the check to the move.
  const auto hold = module->bus->motors().coordinates().holds.set(module->address);
  const auto settled = co_await run_on(*module, call, module->bus->gate().hold_still(module->address));
  if (!settled) co_return tl::unexpected(settled.error());
  auto complaint = co_await check_limits(call, params, *module, motors);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto together = params.interpolated.value_or(false) ? tmcl::Together::interpolated
                                                            : tmcl::Together::each_for_itself;
  auto script =
      tmcl::verbs::move_motors_to_coordinate(module->address, motors, together, params.number);
  auto started = co_await act_on(call, *module, std::move(script));
  co_return started;
}

Answer<coordinate::Store> store_coordinates(Call& call, const coordinate::Store& params) {
  return act_on_eeprom(call, params, tmcl::verbs::store_coordinates);
}
Answer<coordinate::Load> load_coordinates(Call& call, const coordinate::Load& params) {
  return act_on_eeprom(call, params, tmcl::verbs::load_coordinates);
}

}  // namespace tmcld::handlers

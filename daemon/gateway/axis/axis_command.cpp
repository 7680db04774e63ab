// Raw commands to an axis, of all clients that speak TMCL.
#include <utility>

#include "gateway/axis/axis.hpp"
#include "gateway/axis/raw_command.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcld {

using tmcl::Microsteps;

GatewayAxis::Awaitable<tmcl::Answer> GatewayAxis::execute(tmcl::Request request,
                                                          RunOptions movement) {
  const auto action = action_of(request);
  if (!action) co_return co_await bus().execute(request, std::move(movement));
  if (starts_search(request)) bus().motors().let_search(address(), movement.permit);
  auto admitted = co_await admit(*action, std::move(movement));
  if (!admitted) co_return tl::unexpected(std::move(admitted.error()));
  const bool sets = request.command == tmcl::Command::SAP;
  const bool restores = std::holds_alternative<action::Restore>(*action);
  if (!sets) forget_move();
  // What is read or checked while it is on its way may be from before it.
  if (sets) units_.note_set(request.type);
  if (restores) module().note_settings_changed();
  auto answer = co_await execute_admitted(request, std::move(*admitted));
  // Also after a failure: the value may have been set all the same.
  if (sets) units_.note_set(request.type, answer ? std::optional(request.value) : std::nullopt);
  if (restores) module().note_settings_changed();
  if (!sets || request.type != tmcl::axis_parameter::actual_position) co_return answer;
  requested_.reset();
  if (answer) bus().motors().set_referenced(address());
  co_return answer;
}

GatewayAxis::Awaitable<tmcl::Answer> GatewayAxis::execute_admitted(tmcl::Request request,
                                                                   Admitted admitted) {
  admitted.announced = request;
  if (is_move_to_coordinate(request) && soft_limits()) {
    auto script = move_to_read_coordinate(
        request, [aim = admitted](Microsteps there) { aim.aim_at({there}); });
    co_return co_await axis_.run(std::move(script), std::move(admitted));
  }
  if (!is_relative_move(request))
    co_return co_await axis_.run(tmcl::verbs::command(request), std::move(admitted));
  const auto origin = co_await origin_of_relative_moves();
  if (!origin) co_return tl::unexpected(origin.error());
  RelativeMove move;
  move.origin = *origin;
  if (const auto* model = module().model())
    move.answer =
        tmcl::ModuleTraits().get<tmcl::RelativeAnswer>(tmcl::Trait::relative_answer, *model);
  move.aim = [aim = admitted](Microsteps target) { aim.aim_at({target}); };
  co_return co_await axis_.run(move_relatively(request, std::move(move)), std::move(admitted));
}

GatewayAxis::Awaitable<std::uint8_t> GatewayAxis::origin_of_relative_moves() {
  constexpr auto option = tmcl::number_of("relative_positioning_option");
  constexpr std::int32_t from_actual = 1;
  const auto* model = module().model();
  const bool may_be_target = model != nullptr && bus().motors().was_sent_to_position(address()) &&
                             tmcl::ModuleTraits().get<tmcl::RelativeFrom>(
                                 tmcl::Trait::relative_from, *model) == tmcl::RelativeFrom::target;
  if (!may_be_target) co_return tmcl::axis_parameter::actual_position;
  if (find_parameter(parameters(), option) == nullptr)
    co_return tmcl::axis_parameter::target_position;
  const auto chosen = co_await get(option, {});
  if (!chosen) co_return tl::unexpected(chosen.error());
  co_return *chosen == from_actual ? tmcl::axis_parameter::actual_position
                                   : tmcl::axis_parameter::target_position;
}

}  // namespace tmcld

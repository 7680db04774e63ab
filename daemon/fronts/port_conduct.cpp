#include "fronts/port_conduct.hpp"

#include <algorithm>
#include <utility>

#include "api/can_identifiers.hpp"
#include "fronts/port_rules.hpp"
#include "gateway/reach.hpp"
#include "tmcl/coordinates.hpp"
#include "tmcl/model.hpp"

namespace tmcld {
namespace {

using tmcl::Command;
using tmcl::Effect;

constexpr std::uint8_t relative_to_coordinate = 3;  // the type of MVP

tmcl::Error not_permitted(const tmcl::Request& request, std::string why, std::string hint) {
  tmcl::Error error;
  error.code = tmcl::Errc::not_permitted;
  error.outcome = tmcl::Outcome::not_sent;
  error.message = std::move(why);
  error.hint = std::move(hint);
  error.request = request;
  return error;
}

std::string_view word_for(Role role) { return role == Role::configure ? "configure" : "move"; }

/// What an exchange of a program being loaded is.
tmcl::Script<tmcl::Result<tmcl::Answer>> held_exchange(tmcl::Request request,
                                                       tmcl::CallOptions options) {
  co_return co_await tmcl::exchange(request, std::move(options));
}

}  // namespace

PortConduct::PortConduct(std::shared_ptr<Gateway> gateway, std::shared_ptr<GatewayBus> bus,
                         Role role, Client host)
    : gateway_(std::move(gateway)),
      bus_(std::move(bus)),
      role_(role),
      host_(std::move(host)),
      leases_(std::make_shared<PortLeases>(gateway_, host_)) {}

void PortConduct::close() {
  hold_.reset();
  leases_->close();
  gateway_->leave(host_.number);
}

bool PortConduct::is_in_download(const tmcl::Request& request) const {
  return hold_ != nullptr && request.address == held_;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::carry_out(tmcl::Request request, Permit permit,
                                                            Deadline deadline) {
  RunOptions options;
  options.permit = permit;
  options.deadline = deadline;
  if (is_in_download(request)) co_return co_await download(request, std::move(options));
  const auto effect = effect_of(request.command, request.type);
  if (effect == Effect::stops) co_return co_await stop(request);
  if (effect == Effect::reads) co_return co_await bus_->execute(request, std::move(options));
  // Nobody answers for a module that is not there.
  auto there = co_await bus_->add_module(request.address).be_ready();
  const bool has_no_firmware = !there && there.error().code == tmcl::Errc::in_bootloader;
  if (!there && !has_no_firmware) co_return tl::unexpected(std::move(there.error()));
  if (auto objection = objection_to(request)) co_return tl::unexpected(std::move(*objection));
  co_return co_await act(request, std::move(options));
}

std::optional<tmcl::Error> PortConduct::objection_to(const tmcl::Request& request) const {
  const auto needed = role_at_port(request.command, request.type);
  if (role_ < needed) {
    const auto word = std::string(word_for(needed));
    return not_permitted(request, "this port may not do that",
                         "'may' of its [[port]] can say \"" + word + "\"");
  }
  if (auto loss = loss_of_reach(*bus_, request)) return loss;
  if (request.command == Command::MVP && request.type == relative_to_coordinate)
    return not_permitted(request, "a relative move to a coordinate could come twice",
                         "move to the coordinate, or by a distance");
  if (has_address_of_replies(*bus_, request.address))
    return not_permitted(request, "the address of the module is the identifier of replies",
                         "give the module another address");
  const auto conflict = identifier_conflict(*bus_, request);
  if (conflict) return not_permitted(request, conflict->message, {});
  return std::nullopt;
}

/// Whatever else is known or asked: see module.execute of the API.
PortConduct::Awaitable<tmcl::Answer> PortConduct::stop(tmcl::Request request) {
  const tmcl::AxisAddress motor{request.address, request.motor};
  bus_->motors().stop(motor);
  const auto axis = gateway_->find_axis(*bus_, motor);
  if (axis) axis->revoke_movements();
  const StopInProgress in_progress(gateway_);
  auto answer = co_await bus_->execute(request, asked_by(host_.number));
  co_return answer;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::act(tmcl::Request request, RunOptions options) {
  if (names_motor(request) || motion_effect(request) == MotionEffect::turns)
    co_return co_await act_on_axes(request, std::move(options));
  if (request.command == Command::START_DOWNLOAD) {
    hold_ = std::make_shared<const tmcl::Hold>();
    held_ = request.address;
    co_return co_await download(request, std::move(options));
  }
  options.permit.needs_lease = gateway_->moves_need_lease();
  co_return co_await bus_->execute(request, std::move(options));
}

// ---- axes --------------------------------------------------------------------------------------

tmcl::Result<PortConduct::Axes> PortConduct::axes_of(const tmcl::Request& request) {
  const auto* model = bus_->add_module(request.address).model();
  std::set<tmcl::AxisAddress> motors{{request.address, request.motor}};
  if (moves_several(request)) motors = motors_of(request);
  const bool lacks_one = model != nullptr && std::ranges::any_of(motors, [&](const auto& motor) {
                           return motor.motor >= model->axes;
                         });
  if (lacks_one) return Axes();
  Axes axes;
  const auto buses = gateway_->buses();
  const auto bus = std::ranges::find(buses, bus_);
  for (const auto& motor : motors) {
    auto axis = gateway_->find_axis(*bus_, motor);
    if (!axis) axis = gateway_->add_axis(*bus, motor);
    if (!axis)
      return tl::unexpected(not_permitted(request, "too many motors have no axis",
                                          "put the axes that are in use into the configuration"));
    axes.push_back(std::move(axis));
  }
  return axes;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::act_on_axes(tmcl::Request request,
                                                              RunOptions options) {
  auto axes = axes_of(request);
  if (!axes) co_return tl::unexpected(std::move(axes.error()));
  // The module will say what it thinks of such a motor.
  if (axes->empty()) co_return co_await bus_->execute(request, std::move(options));
  for (const auto& axis : *axes) {
    if (starts_search(request)) bus_->motors().let_search(axis->address(), options.permit);
    auto taken = co_await leases_->take(axis, options.permit);
    if (!taken) co_return tl::unexpected(std::move(taken.error()));
  }
  auto answer = co_await act_on(*axes, request, std::move(options));
  co_return answer;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::act_on(Axes axes, tmcl::Request request,
                                                         RunOptions options) {
  if (axes.size() == 1) co_return co_await axes.front()->execute(request, std::move(options));
  const auto hold = bus_->motors().coordinate_holds().set(request.address);
  auto still = bus_->hold_still(request.address);
  const auto settled = co_await bus_->run(std::move(still), options);
  if (!settled) co_return tl::unexpected(settled.error());
  for (const auto& axis : axes) {
    auto movement = axis->begin_movement(options.permit, options.deadline);
    auto allowed = co_await axis->check_coordinate(static_cast<std::uint8_t>(request.value),
                                                   std::move(movement));
    if (!allowed) co_return tl::unexpected(std::move(allowed.error()));
  }
  co_return co_await bus_->execute(request, std::move(options));
}

// ---- programs ----------------------------------------------------------------------------------

/// Everything between START_DOWNLOAD and END_DOWNLOAD is recorded by the module, and nobody else
/// speaks to it meanwhile.
PortConduct::Awaitable<tmcl::Answer> PortConduct::download(tmcl::Request request,
                                                           RunOptions options) {
  tmcl::CallOptions call;
  call.hold = hold_;
  const bool frames =
      request.command == Command::START_DOWNLOAD || request.command == Command::END_DOWNLOAD;
  call.is_program_line = !frames;
  auto script = held_exchange(request, std::move(call));
  auto answer = co_await bus_->run(std::move(script), std::move(options));
  const bool has_ended = request.command == Command::END_DOWNLOAD || !answer;
  if (has_ended) hold_.reset();
  co_return answer;
}

}  // namespace tmcld

#include "fronts/port_conduct.hpp"

#include <algorithm>
#include <utility>

#include "api/can_identifiers.hpp"
#include "async/spawn.hpp"
#include "fronts/port_rules.hpp"
#include "gateway/authority/reach.hpp"
#include "tmcl/intent.hpp"
#include "tmcl/model.hpp"
#include "tmcl/parameter.hpp"

namespace tmcld {
namespace {

using tmcl::Command;
using tmcl::Effect;

constexpr std::uint8_t relative_to_coordinate = 3;  // the type of MVP
constexpr std::uint8_t first_control_function = 128;

tmcl::Error not_permitted(const tmcl::Request& request, std::string why, std::string hint) {
  auto error = tmcl::not_sent(tmcl::Errc::not_permitted, std::move(why), std::move(hint));
  error.request = request;
  return error;
}

/// Hosts of modules on USB greet with nine zero bytes, and every module refuses what that says.
constexpr Command no_command{0};

tmcl::Request version_request(tmcl::ModuleAddress module) {
  return {module, Command::GET_FIRMWARE_VERSION,
          static_cast<std::uint8_t>(tmcl::VersionForm::binary), 0, 0};
}

tmcl::Request address_request(tmcl::ModuleAddress module) {
  return {module, Command::GGP, tmcl::global_parameter::serial_address, 0, 0};
}

/// A host that asks something else before this is answered does not wait for it any more.
PortConduct::Awaitable<tmcl::Answer> once(std::shared_ptr<GatewayBus> bus, tmcl::Request request,
                                          std::uint64_t client, Deadline deadline) {
  auto options = asked_by(client);
  options.deadline = deadline;
  tmcl::CallOptions call;
  call.attempts = 1;
  auto script = tmcl::verbs::command(request, std::move(call));
  co_return co_await bus->run(std::move(script), std::move(options));
}

/// Too late to be sent; but the bus sees that the host is through with what it has tried.
boost::asio::awaitable<void> give_up(std::shared_ptr<GatewayBus> bus, tmcl::Request request,
                                     std::uint64_t client) {
  const auto now = bus->clock().now();
  co_await once(std::move(bus), request, client, now);
}

tmcl::Error refused_as_unknown(const tmcl::Request& request) {
  tmcl::Error error;
  error.code = tmcl::Errc::refused_by_module;
  error.outcome = tmcl::Outcome::refused;
  error.message = "there is no such command";
  error.request = request;
  error.status = tmcl::Status::invalid_command;
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
  gateway_->remove_client(host_.number);
}

bool PortConduct::is_in_download(const tmcl::Request& request) const {
  return hold_ != nullptr && request.address == held_;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::carry_out(tmcl::Request request, Permit permit,
                                                            Deadline deadline, bool only_tries) {
  RunOptions options;
  options.permit = permit;
  options.deadline = deadline;
  if (is_in_download(request)) co_return co_await download(request, std::move(options));
  const auto effect = effect_of(request.command, request.type);
  if (effect == Effect::stops) co_return co_await stop(request, only_tries);
  const bool reads = effect == Effect::reads;
  if (reads && only_tries) co_return co_await try_once(request, deadline);
  if (reads) co_return co_await bus_->execute(request, std::move(options));
  // No answer is made up for a module that is not there.
  if (only_tries) {
    auto answer = co_await try_once(version_request(request.address), deadline);
    const bool is_silent = !answer && answer.error().outcome != tmcl::Outcome::refused;
    if (is_silent) co_return answer;
  }
  auto there = co_await bus_->add_module(request.address).be_ready();
  const bool has_no_firmware = !there && there.error().code == tmcl::Errc::in_bootloader;
  if (!there && !has_no_firmware) co_return tl::unexpected(std::move(there.error()));
  if (request.command == no_command) co_return tl::unexpected(refused_as_unknown(request));
  if (auto objection = objection_to(request)) co_return tl::unexpected(std::move(*objection));
  co_return co_await act(request, std::move(options));
}

// ---- which module it is -------------------------------------------------------------------------

bool PortConduct::is_ready(tmcl::ModuleAddress module) const {
  const auto* found = bus_->find_module(module);
  return found != nullptr && found->state() == GatewayModule::State::ready;
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::try_once(const tmcl::Request& request,
                                                           Deadline deadline) {
  return once(bus_, request, host_.number, deadline);
}

void PortConduct::give_up_tries(tmcl::ModuleAddress module) {
  spawn(bus_->executor(), give_up(bus_, version_request(module), host_.number));
}

/// As far as is known, there is no more than one module on the bus, and this is not its address.
bool PortConduct::may_take_any_address(tmcl::ModuleAddress module) const {
  const auto others = known_modules();
  return !bus_->is_can() && others.size() <= 1 && !others.contains(module);
}

std::set<tmcl::ModuleAddress> PortConduct::known_modules() const {
  std::set<tmcl::ModuleAddress> known;
  for (const auto& [address, module] : bus_->modules())
    if (module->is_configured() || module->identity()) known.insert(address);
  return known;
}

tmcl::ModuleAddress PortConduct::known_meaning(tmcl::ModuleAddress address) const {
  return only_module_ && may_take_any_address(address) ? *only_module_ : address;
}

/// One answer from another address may be a reply to another host. So that address is asked for in
/// two ways, and has to say that it is what answers.
PortConduct::Awaitable<tmcl::ModuleAddress> PortConduct::find_meaning(tmcl::ModuleAddress address,
                                                                      Deadline deadline) {
  if (!may_take_any_address(address)) co_return address;
  const auto first = co_await try_once(version_request(address), deadline);
  if (!first && first.error().outcome == tmcl::Outcome::refused) co_return address;
  if (!first) co_return tl::unexpected(first.error());
  const auto answering = first->reply.module;
  if (answering == reply_byte(address)) co_return address;
  const auto second = co_await try_once(address_request(address), deadline);
  const bool is_it =
      second && second->reply.module == answering && second->reply.value == answering;
  if (!is_it) co_return address;
  only_module_ = tmcl::ModuleAddress{answering};
  co_return *only_module_;
}

// ---- what it may do -----------------------------------------------------------------------------

std::optional<tmcl::Error> PortConduct::objection_to(const tmcl::Request& request) const {
  const auto needed = role_at_port(request);
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

/// Whatever else is known or asked: see module.execute of the API. To an unknown module it
/// goes once, as the host has said it. The only module of a bus may have taken it.
PortConduct::Awaitable<tmcl::Answer> PortConduct::stop(tmcl::Request request, bool only_tries) {
  const bool is_known = !only_tries || known_modules().contains(request.address);
  revoke_movements(request);
  const StopInProgress in_progress(gateway_);
  auto sent = is_known ? bus_->execute(request, asked_by(host_.number)) : try_once(request, {});
  auto answer = co_await std::move(sent);
  if (!answer) co_return answer;
  if (answer->reply.module != reply_byte(request.address)) {
    request.address = tmcl::ModuleAddress{answer->reply.module};
    revoke_movements(request);
  }
  co_return answer;
}

void PortConduct::revoke_movements(const tmcl::Request& stop) {
  const tmcl::AxisAddress motor{stop.address, stop.motor};
  bus_->motors().stop(motor);
  if (const auto axis = gateway_->find_axis(*bus_, motor)) axis->revoke_movements();
}

PortConduct::Awaitable<tmcl::Answer> PortConduct::act(tmcl::Request request, RunOptions options) {
  const auto subject = intent_of(request).subject;
  if (subject != tmcl::Subject::module && subject != tmcl::Subject::output)
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
  const bool is_register = intent_of(request).subject == tmcl::Subject::chip;
  const auto motors = is_register ? tmcl::motors_turned_by(request, model) : motors_of(request);
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
  if (intent_of(request).subject != tmcl::Subject::several)
    co_return co_await bus_->execute(request, std::move(options));
  const auto hold = bus_->motors().coordinates().holds.set(request.address);
  auto still = bus_->gate().hold_still(request.address);
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

/// What follows a line that is missing would stand at wrong addresses, and jumps would lead
/// elsewhere. Commands from 128 on are carried out, also while a program is loaded.
std::optional<tmcl::Error> PortConduct::objection_to_line(const tmcl::Request& line) {
  if (static_cast<std::uint8_t>(line.command) >= first_control_function) return objection_to(line);
  auto loss = loss_of_reach(*bus_, line);
  if (!loss && lacks_a_line_)
    loss = not_permitted(line, "a line of this program was refused",
                         "END_DOWNLOAD, and load it without that line");
  lacks_a_line_ = loss.has_value();
  return loss;
}

/// Everything below 128 between START_DOWNLOAD and END_DOWNLOAD is recorded by the module, and
/// only the host that began speaks to it meanwhile.
PortConduct::Awaitable<tmcl::Answer> PortConduct::download(tmcl::Request request,
                                                           RunOptions options) {
  tmcl::CallOptions call;
  call.hold = hold_;
  const bool frames =
      request.command == Command::START_DOWNLOAD || request.command == Command::END_DOWNLOAD;
  call.is_program_line = !frames;
  if (frames) lacks_a_line_ = false;
  if (auto objection = frames ? std::nullopt : objection_to_line(request))
    co_return tl::unexpected(std::move(*objection));
  auto script = held_exchange(request, std::move(call));
  auto answer = co_await bus_->run(std::move(script), std::move(options));
  const bool has_ended = request.command == Command::END_DOWNLOAD || !answer;
  if (has_ended) hold_.reset();
  co_return answer;
}

}  // namespace tmcld

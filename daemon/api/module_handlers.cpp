#include "api/can_identifiers.hpp"
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "api/suggest.hpp"
#include "api/views.hpp"
#include "gateway/authority/reach.hpp"

namespace tmcld::handlers {
namespace {

Result<tmcl::Command> command_of(const api::NameOrNumber& given) {
  if (const auto* number = std::get_if<std::int32_t>(&given.said))
    return static_cast<tmcl::Command>(*number);
  const auto& text = std::get<std::string>(given.said);
  if (const auto command = tmcl::parse_command(text)) return *command;
  std::vector<std::string_view> names;
  for (const auto& row : tmcl::command_table()) names.push_back(row.name);
  constexpr auto otherwise = "give a TMCL mnemonic such as GAP, or a number 0..255";
  return tl::unexpected(param_error<&module::Execute::command>(
      "unknown_command", "there is no command '" + text + "'", suggest(text, names, otherwise)));
}

Result<std::uint8_t> type_of(const api::NameOrNumber& given, tmcl::Command command) {
  if (const auto* number = std::get_if<std::int32_t>(&given.said))
    return static_cast<std::uint8_t>(*number);
  const auto& text = std::get<std::string>(given.said);
  if (const auto type = tmcl::parse_subtype(command, text)) return *type;
  return tl::unexpected(param_error<&module::Execute::type>(
      "bad_argument", std::string(tmcl::name_of(command)) + " has no type '" + text + "'",
      "give its number"));
}

Result<tmcl::Request> request_of(const module::Execute& params) {
  const auto command = command_of(params.command);
  if (!command) return tl::unexpected(command.error());
  const auto type = type_of(params.type.value_or(0), *command);
  if (!type) return tl::unexpected(type.error());
  return tmcl::Request{address_of(params), *command, *type, params.motor.value_or(0),
                       params.value.value_or(0)};
}

// A stop is a stop, also if it comes as a raw command, and for a motor that has no axis.
void revoke_movements(const Call& call, GatewayBus& bus, const tmcl::Request& request) {
  bus.motors().stop({request.address, request.motor});
  const auto axis = call.gateway->find_axis(bus, {request.address, request.motor});
  if (axis) axis->revoke_movements();
}

/// Motors that may not come to stand by themselves: a search that meets no switch has no end.
std::set<tmcl::AxisAddress> motors_without_end(const tmcl::Request& request,
                                               const tmcl::Model* model) {
  if (!starts_search(request)) return tmcl::motors_turned_by(request, model);
  const bool has_motor = model == nullptr || request.motor < model->axes;
  return has_motor ? motors_of(request) : std::set<tmcl::AxisAddress>{};
}

/// What has no end is stopped when its client goes or its link is back: it needs an axis.
std::optional<Error> give_axes(const Call& call, const std::shared_ptr<GatewayBus>& bus,
                               const tmcl::Request& request) {
  for (const auto motor : motors_without_end(request, bus->model_of(request.address))) {
    if (call.gateway->find_axis(*bus, motor) || call.gateway->add_axis(bus, motor)) continue;
    return not_now("not_permitted",
                   "motor " + std::to_string(motor.motor) + " of module " +
                       std::to_string(number(motor.module)) +
                       " has no axis, and too many motors without one are in use",
                   "put the axes that are in use into the configuration");
  }
  return std::nullopt;
}

/// Nothing if there is nothing to say.
std::optional<std::vector<std::string>> warnings_about(Call& call, GatewayBus& bus,
                                                       const tmcl::Request& request) {
  std::vector<std::string> warnings;
  const auto intent = intent_of(request);
  const auto* does = intent.subject == tmcl::Subject::chip ? "may turn" : "turns";
  for (const auto motor : tmcl::motors_turned_by(request, bus.model_of(request.address)))
    if (const auto axis = call.gateway->find_axis(bus, motor))
      if (auto warning = warning_of_owner(call, *axis, does))
        warnings.push_back(std::move(*warning));
  call.unattended = is_unpredictable(intent.motion);
  if (call.unattended)
    warnings.emplace_back(
        "what this sets turning has no owner: it is unattended, and turns on "
        "when the connection ends");
  return warnings.empty() ? std::nullopt : std::optional(std::move(warnings));
}

module::Reply to_result(const tmcl::Answer& answer) {
  module::Reply result{static_cast<std::uint8_t>(answer.reply.status),
                       std::string(tmcl::name_of(answer.reply.status)),
                       static_cast<std::uint8_t>(answer.reply.command), answer.reply.value};
  if (answer.version_text) {
    const auto text = tmcl::to_text(*answer.version_text);
    result.text.emplace(text.data(), text.size());
  }
  return result;
}

/// A suspicion ends when no surplus reply has come for a while, which the next answer tells.
boost::asio::awaitable<void> look_for_duplicates(const Call& call) {
  const auto open = call.gateway->buses();
  const std::vector<std::shared_ptr<GatewayBus>> buses(open.begin(), open.end());
  for (const auto& bus : buses) {
    std::vector<tmcl::ModuleAddress> suspects;
    for (const auto& [address, module] : bus->modules())
      if (module->duplicate_suspected()) suspects.push_back(address);
    for (const auto address : suspects)
      co_await bus->execute(
          {address, tmcl::Command::GAP, tmcl::axis_parameter::actual_position, 0, 0},
          asked_by(call.permit.client));
  }
}

}  // namespace

Answer<module::List> list_modules(Call& call, const module::List&) {
  co_await look_for_duplicates(call);
  module::Modules result;
  for (const auto& bus : call.gateway->buses()) {
    for (const auto& [address, module] : bus->modules())
      if (module->is_configured()) result.modules.push_back(view_of(*bus, *module));
  }
  co_return result;
}

Answer<module::Execute> execute(Call& call, const module::Execute& params) {
  const auto bus = co_await must(bus_of(call, params.bus));
  const auto request = co_await must(request_of(params));
  co_await must_not(identifier_conflict(*bus, request));
  co_await must_not(
      objection_by_role(call.caller, role_for(intent_of(request)),
                        "module.execute of " + std::string(tmcl::name_of(request.command))));
  co_await must_not(loss_of_reach(*bus, request));
  call.effect = intent_of(request).effect;
  // Its model says whose register it is. One that does not tell may take it all the same.
  if (intent_of(request).subject == tmcl::Subject::chip)
    co_await bus->add_module(request.address).be_ready();
  co_await must_not(give_axes(call, bus, request));
  const bool stops = call.effect == tmcl::Effect::stops;
  if (stops) revoke_movements(call, *bus, request);
  std::optional<StopInProgress> in_progress;
  if (stops) in_progress.emplace(call.gateway);
  const auto answer = co_await must(bus->execute(request, in_time(call, params)));
  auto result = to_result(answer);
  result.warnings = warnings_about(call, *bus, request);
  co_return result;
}

Answer<module::Info> module_info(Call& call, const module::Info& params) {
  const auto module = co_await must(module_of(call, params));
  auto info = co_await must(run_on(module, call, tmcl::verbs::firmware_info(module.address)));
  co_return module::FirmwareInfo{info.module_id,
                                 info.version,
                                 info.capabilities,
                                 info.release_type,
                                 info.bootloader_id,
                                 info.bootloader_version,
                                 info.axis_parameter_width,
                                 info.register_address_width,
                                 info.git_hash};
}

Answer<module::ReportArrivals> report_arrivals(Call& call, const module::ReportArrivals& params) {
  const auto events = params.every.value_or(false) ? tmcl::ArrivalEvents::every_move
                                                   : tmcl::ArrivalEvents::next_move;
  const auto motors = static_cast<std::int32_t>(mask_of(params.motors));
  return act_on(call, params,
                tmcl::verbs::request_arrival_events(address_of(params), events, motors));
}

Answer<module::Reset> reset_module(Call& call, const module::Reset& params) {
  return act_on(call, params, tmcl::verbs::reset_module(address_of(params)), makes_news);
}

Answer<module::FactoryReset> factory_reset(Call& call, const module::FactoryReset& params) {
  return act_on(call, params, tmcl::verbs::factory_reset(address_of(params)), makes_news);
}

}  // namespace tmcld::handlers

#include <array>

#include <boost/json/array.hpp>

#include "api/can_identifiers.hpp"
#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/state_json.hpp"
#include "api/suggest.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

Lookup<tmcl::Command> command_of(const Call& call) {
  if (!call.params.is_text("command")) {
    return static_cast<tmcl::Command>(call.params.integer("command"));
  }
  const auto text = call.params.text("command");
  if (const auto command = tmcl::parse_command(text)) return *command;
  std::vector<std::string_view> names;
  for (const auto& row : tmcl::command_table()) names.push_back(row.name);
  constexpr auto otherwise = "give a TMCL mnemonic such as GAP, or a number 0..255";
  return tl::unexpected(param_error("unknown_command", "command",
                                    "there is no command '" + text + "'",
                                    suggest(text, names, otherwise)));
}

Lookup<std::uint8_t> type_of(const Call& call, tmcl::Command command) {
  if (!call.params.has("type")) return std::uint8_t{0};
  if (!call.params.is_text("type")) return static_cast<std::uint8_t>(call.params.integer("type"));
  const auto text = call.params.text("type");
  if (const auto type = tmcl::parse_subtype(command, text)) return *type;
  return tl::unexpected(param_error(
      "bad_argument", "type", std::string(tmcl::name_of(command)) + " has no type '" + text + "'",
      "give its number"));
}

Lookup<tmcl::Request> request_of(const Call& call) {
  tmcl::Request request;
  request.address = tmcl::ModuleAddress{static_cast<std::uint16_t>(call.params.integer("address"))};
  const auto command = command_of(call);
  if (!command) return tl::unexpected(command.error());
  request.command = *command;
  const auto type = type_of(call, *command);
  if (!type) return tl::unexpected(type.error());
  request.type = *type;
  request.motor = static_cast<std::uint8_t>(call.params.integer_or("motor", 0));
  request.value = call.params.integer_or("value", 0);
  return request;
}

// A stop is a stop, also if it comes as a raw command, and for a motor that has no axis.
void revoke_movements(const Call& call, GatewayBus& bus, const tmcl::Request& request) {
  bus.motors().stop({request.address, request.motor});
  const auto axis = call.gateway->find_axis(bus, {request.address, request.motor});
  if (axis) axis->revoke_movements();
}

json::object to_result(const tmcl::Answer& answer) {
  json::object result;
  result["status"] = static_cast<std::uint8_t>(answer.reply.status);
  result["status_name"] = tmcl::name_of(answer.reply.status);
  result["command"] = static_cast<std::uint8_t>(answer.reply.command);
  result["value"] = answer.reply.value;
  result["text"] = nullptr;
  if (answer.version_text) {
    const auto text = tmcl::to_text(*answer.version_text);
    result["text"] = std::string_view(text.data(), text.size());
  }
  return result;
}

}  // namespace

Answer list_modules(Call& call) {
  json::array modules;
  for (const auto& bus : call.gateway->buses()) {
    for (const auto& [address, module] : bus->modules())
      if (module->is_configured()) modules.push_back(to_json(*bus, *module));
  }
  json::object result;
  result["modules"] = std::move(modules);
  co_return result;
}

Answer execute(Call& call) {
  const auto bus = bus_of(call);
  if (!bus) co_return tl::unexpected(bus.error());
  const auto request = request_of(call);
  if (!request) co_return tl::unexpected(request.error());
  if (auto conflict = identifier_conflict(**bus, *request))
    co_return tl::unexpected(std::move(*conflict));
  const bool stops = effect_of(request->command, request->type) == tmcl::Effect::stops;
  if (stops) revoke_movements(call, **bus, *request);
  RunOptions options;
  options.deadline = call.deadline();
  options.permit = call.permit;
  call.gateway->stops_in_progress += stops ? 1 : 0;
  const auto answer = co_await (*bus)->execute(*request, options);
  call.gateway->stops_in_progress -= stops ? 1 : 0;
  if (!answer) co_return tl::unexpected(call_error(answer.error()));
  co_return to_result(*answer);
}

}  // namespace tmcld::handlers

// Global parameters, ports, and what else concerns a module as a whole.
#include "api/can_identifiers.hpp"
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "api/suggest.hpp"
#include "tmcl/model.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

struct GlobalChoice {
  ModuleChoice module;
  std::uint8_t bank = 0;
  std::uint8_t number = 0;
  const tmcl::ParameterInfo* row = nullptr;
};

RpcError unknown_global(const std::string& name, std::span<const tmcl::ParameterInfo> rows) {
  std::vector<std::string_view> names;
  for (const auto& row : rows) names.push_back(row.name);
  return param_error("unknown_parameter", "parameter",
                     "there is no global parameter '" + name + "'",
                     suggest(name, names, "give its number, 0..255"));
}

/// Which names there are depends on the model, and only bank 0 has any.
boost::asio::awaitable<Lookup<GlobalChoice>> global_of(const Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  GlobalChoice choice{*module, static_cast<std::uint8_t>(call.params.integer_or("bank", 0)), 0,
                      nullptr};
  if (!call.params.is_text("parameter")) {
    choice.number = static_cast<std::uint8_t>(call.params.integer("parameter"));
    co_return choice;
  }
  const auto name = call.params.text("parameter");
  if (const auto number = as_number(name)) {
    choice.number = *number;
    co_return choice;
  }
  if (choice.bank != 0) co_return tl::unexpected(unknown_global(name, {}));
  auto found = co_await run_on(*module, call, tmcl::verbs::identify(module->address));
  if (!found) co_return tl::unexpected(std::move(found.error()));
  const auto* model = tmcl::find_model(found->version.model);
  const auto rows =
      model == nullptr ? std::span<const tmcl::ParameterInfo>{} : tmcl::global_parameters(*model);
  choice.row = find_parameter(rows, name);
  if (choice.row == nullptr) co_return tl::unexpected(unknown_global(name, rows));
  choice.number = choice.row->number;
  co_return choice;
}

json::object to_json(const GlobalChoice& choice) {
  json::object result;
  result["parameter"] = nullptr;
  if (choice.row != nullptr) result["parameter"] = choice.row->name;
  result["number"] = choice.number;
  result["bank"] = choice.bank;
  return result;
}

json::object with_value(json::object result, std::int32_t value) {
  result["value"] = value;
  return result;
}

json::value or_null(std::optional<std::int32_t> value) {
  return value ? json::value(*value) : json::value(nullptr);
}

}  // namespace

Answer get_global(Call& call) {
  const auto choice = co_await global_of(call);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto& module = choice->module;
  auto value = co_await run_on(
      module, call, tmcl::verbs::get_global(module.address, choice->bank, choice->number));
  if (!value) co_return tl::unexpected(std::move(value.error()));
  co_return with_value(to_json(*choice), *value);
}

Answer set_global(Call& call) {
  const auto choice = co_await global_of(call);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto value = call.params.integer("value");
  if (auto complaint = check_range(choice->row, value, "value"))
    co_return tl::unexpected(std::move(*complaint));
  const auto& module = choice->module;
  const tmcl::Request request{module.address, tmcl::Command::SGP, choice->number, choice->bank,
                              value};
  if (auto conflict = identifier_conflict(*module.bus, request))
    co_return tl::unexpected(std::move(*conflict));
  auto done = co_await run_on(
      module, call, tmcl::verbs::set_global(module.address, choice->bank, choice->number, value));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return with_value(to_json(*choice), value);
}

Answer store_global(Call& call) {
  const auto choice = co_await global_of(call);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto& module = choice->module;
  auto done = co_await run_on(
      module, call, tmcl::verbs::store_global(module.address, choice->bank, choice->number));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return to_json(*choice);
}

Answer restore_global(Call& call) {
  const auto choice = co_await global_of(call);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto& module = choice->module;
  auto done = co_await run_on(
      module, call, tmcl::verbs::restore_global(module.address, choice->bank, choice->number));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return to_json(*choice);
}

Answer get_io(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto bank = static_cast<tmcl::IoBank>(call.params.integer_or("bank", 0));
  const auto port = static_cast<std::uint8_t>(call.params.integer("port"));
  auto value = co_await run_on(*module, call, tmcl::verbs::get_io(module->address, bank, port));
  if (!value) co_return tl::unexpected(std::move(value.error()));
  co_return with_value({}, *value);
}

Answer set_io(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto port = static_cast<std::uint8_t>(call.params.integer("port"));
  const auto value = call.params.integer("value");
  auto done = co_await run_on(*module, call, tmcl::verbs::set_output(module->address, port, value));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return with_value({}, value);
}

Answer module_info(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto info = co_await run_on(*module, call, tmcl::verbs::firmware_info(module->address));
  if (!info) co_return tl::unexpected(std::move(info.error()));
  json::object result;
  result["module_id"] = or_null(info->module_id);
  result["version"] = or_null(info->version);
  result["capabilities"] = or_null(info->capabilities);
  result["release_type"] = or_null(info->release_type);
  result["bootloader_id"] = or_null(info->bootloader_id);
  result["bootloader_version"] = or_null(info->bootloader_version);
  result["axis_parameter_width"] = or_null(info->axis_parameter_width);
  result["register_address_width"] = or_null(info->register_address_width);
  result["git_hash"] = or_null(info->git_hash);
  co_return result;
}

Answer report_arrivals(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  const auto events = call.params.boolean_or("every", false) ? tmcl::ArrivalEvents::every_move
                                                             : tmcl::ArrivalEvents::next_move;
  const auto motors = static_cast<std::int32_t>(call.params.mask("motors"));
  auto script = tmcl::verbs::request_arrival_events(module->address, events, motors);
  auto done = co_await run_on(*module, call, std::move(script));
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

Answer reset_module(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto done = co_await run_on(*module, call, tmcl::verbs::reset_module(module->address));
  expect_news(*module);
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

Answer factory_reset(Call& call) {
  const auto module = module_of(call);
  if (!module) co_return tl::unexpected(module.error());
  auto done = co_await run_on(*module, call, tmcl::verbs::factory_reset(module->address));
  expect_news(*module);
  if (!done) co_return tl::unexpected(std::move(done.error()));
  co_return json::object{};
}

}  // namespace tmcld::handlers

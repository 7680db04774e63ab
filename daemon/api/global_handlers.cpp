// Global parameters, and ports.
#include "api/can_identifiers.hpp"
#include "api/handlers.hpp"
#include "api/module_choice.hpp"
#include "api/suggest.hpp"
#include "gateway/authority/reach.hpp"
#include "tmcl/model.hpp"

namespace tmcld::handlers {
namespace {

using boost::asio::awaitable;

struct GlobalChoice {
  ModuleChoice module;
  std::uint8_t bank = 0;
  std::uint8_t number = 0;
  const tmcl::ParameterInfo* row = nullptr;

  global::Global told() const {
    global::Global told{{}, number, bank};
    if (row != nullptr) told.parameter = row->name;
    return told;
  }
};

Error unknown_global(const std::string& name, std::span<const tmcl::ParameterInfo> rows) {
  std::vector<std::string_view> names;
  for (const auto& row : rows) names.push_back(row.name);
  return param_error<&global::Get::parameter>("unknown_parameter",
                                              "there is no global parameter '" + name + "'",
                                              suggest(name, names, "give its number, 0..255"));
}

/// Which names there are depends on the model, and only bank 0 has any.
Task<GlobalChoice> global_of(const Call& call, const global::OnGlobal& params) {
  const auto module = co_await must(module_of(call, params));
  GlobalChoice choice{module, params.bank.value_or(0)};
  if (const auto* number = std::get_if<std::int32_t>(&params.parameter.said)) {
    choice.number = static_cast<std::uint8_t>(*number);
    co_return choice;
  }
  const auto& name = std::get<std::string>(params.parameter.said);
  if (const auto number = as_number(name)) {
    choice.number = *number;
    co_return choice;
  }
  if (choice.bank != 0) co_return tl::unexpected(unknown_global(name, {}));
  auto found = co_await must(run_on(module, call, tmcl::verbs::identify(module.address)));
  const auto* model = tmcl::find_model(found.version.model);
  const auto rows =
      model == nullptr ? std::span<const tmcl::ParameterInfo>{} : tmcl::global_parameters(*model);
  choice.row = find_parameter(rows, name);
  if (choice.row == nullptr) co_return tl::unexpected(unknown_global(name, rows));
  choice.number = choice.row->number;
  co_return choice;
}

Task<global::Global> act_on_eeprom(Call& call, const global::OnGlobal& params,
                                   tmcl::Script<tmcl::Result<void>> (*verb)(tmcl::ModuleAddress,
                                                                            std::uint8_t,
                                                                            std::uint8_t)) {
  const auto choice = co_await must(global_of(call, params));
  const auto& module = choice.module;
  co_await must(run_on(module, call, verb(module.address, choice.bank, choice.number)));
  co_return choice.told();
}

}  // namespace

Answer<global::Get> get_global(Call& call, const global::Get& params) {
  const auto choice = co_await must(global_of(call, params));
  const auto& module = choice.module;
  auto value = co_await must(
      run_on(module, call, tmcl::verbs::get_global(module.address, choice.bank, choice.number)));
  co_return global::GlobalValue{choice.told(), value};
}

Answer<global::Set> set_global(Call& call, const global::Set& params) {
  const auto choice = co_await must(global_of(call, params));
  co_await must_not(check_range(choice.row, params.value, api::name_of<&global::Set::value>()));
  const auto& module = choice.module;
  const tmcl::Request request{module.address, tmcl::Command::SGP, choice.number, choice.bank,
                              params.value};
  co_await must_not(identifier_conflict(*module.bus, request));
  co_await must_not(loss_of_moving_motor(*module.bus, request));
  co_await must(
      run_on(module, call,
             tmcl::verbs::set_global(module.address, choice.bank, choice.number, params.value)));
  co_return global::GlobalValue{choice.told(), params.value};
}

Answer<global::Store> store_global(Call& call, const global::Store& params) {
  return act_on_eeprom(call, params, tmcl::verbs::store_global);
}
Answer<global::Restore> restore_global(Call& call, const global::Restore& params) {
  return act_on_eeprom(call, params, tmcl::verbs::restore_global);
}

Answer<io::Get> get_io(Call& call, const io::Get& params) {
  const auto module = co_await must(module_of(call, params));
  const auto bank = static_cast<tmcl::IoBank>(params.bank.value_or(0));
  auto value =
      co_await must(run_on(module, call, tmcl::verbs::get_io(module.address, bank, params.port)));
  co_return io::PortValue{value};
}

Answer<io::Set> set_io(Call& call, const io::Set& params) {
  co_await must(
      act_on(call, params, tmcl::verbs::set_output(address_of(params), params.port, params.value)));
  co_return io::PortValue{params.value};
}

}  // namespace tmcld::handlers

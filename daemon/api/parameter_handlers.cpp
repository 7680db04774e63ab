// Axis parameters, and those in the EEPROM.
#include <algorithm>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/views.hpp"

namespace tmcld::handlers {
namespace {

bool is_of_ramp(const tmcl::Model& model, std::uint8_t parameter) {
  const auto all = tmcl::plan::AxisTwin::parameters(model);
  // On a TMC457, max_acceleration is two of them at once.
  return parameter == tmcl::axis_parameter::max_acceleration ||
         std::ranges::find(all, parameter) != all.end();
}

/// What has been set already is set, whatever comes of reading the rest of the ramp.
boost::asio::awaitable<std::vector<std::string>> warnings_of(GatewayAxis& axis,
                                                             std::uint8_t parameter,
                                                             std::uint64_t client) {
  const auto* model = axis.module().model();
  if (model == nullptr || !is_of_ramp(*model, parameter)) co_return std::vector<std::string>();
  auto warnings = co_await axis.warnings(client);
  if (!warnings) co_return std::vector{"no prediction: " + warnings.error().message};
  co_return std::move(*warnings);
}

boost::asio::awaitable<parameter::Value> to_result(GatewayAxis& axis, ParameterChoice choice,
                                                   ModuleValue value) {
  parameter::Value result{{choice.name(), choice.number}, value.value};
  auto told = co_await in_unit(axis, choice.row, std::move(value));
  result.unit = std::move(told.unit);
  result.value_in_unit = told.number;
  co_return result;
}

std::optional<Error> check_write(const ParameterChoice& choice) {
  if (choice.row == nullptr || choice.row->access != tmcl::Access::read) return std::nullopt;
  return param_error<&parameter::Set::parameter>(
      "read_only", "'" + std::string(choice.row->name) + "' can only be read");
}

using ParameterVerb = GatewayAxis::Awaitable<void> (GatewayAxis::*)(std::uint8_t, RunOptions);

Task<parameter::Number> act_on_eeprom(Call& call, const parameter::OnParameter& params,
                                      ParameterVerb verb) {
  // What is restored can move the motor.
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto choice = co_await must(parameter_of(params.parameter, axis));
  co_await must((axis.*verb)(choice.number, ready.moves), axis);
  co_return parameter::Number{choice.name(), choice.number};
}

}  // namespace

Answer<parameter::Get> get_parameter(Call& call, const parameter::Get& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  auto& it = *axis;
  // Which names there are depends on the model.
  co_await must(it.be_ready(), it);
  const auto choice = co_await must(parameter_of(params.parameter, it));
  auto script = tmcl::verbs::get(it.address(), choice.number);
  const auto value = co_await must(it.perform(std::move(script), in_time(call, params)), it);
  ModuleValue told{value};
  auto result = co_await to_result(it, choice, std::move(told));
  co_return result;
}

Answer<parameter::Set> set_parameter(Call& call, const parameter::Set& params) {
  const auto ready = co_await must(ready_to_move(call, params));
  auto& axis = *ready.axis;
  const auto choice = co_await must(parameter_of(params.parameter, axis));
  co_await must_not(objection_by_role(
      call.caller, role_for(tmcl::intent_of(tmcl::Command::SAP, choice.number)),
      "parameter.set of " + choice.name().value_or(std::to_string(choice.number))));
  co_await must_not(check_write(choice));
  const auto said = raw_or_quantity<&parameter::Set::value, &parameter::Set::value_in_unit>(params);
  const auto value = co_await must(parameter_value_of(axis, said, choice));
  co_await must(axis.set(choice.number, value.value, ready.moves), axis);
  auto warnings = co_await warnings_of(axis, choice.number, call.permit.client);
  const tmcl::Request sent{axis.address().module, tmcl::Command::SAP, choice.number,
                           axis.address().motor, value.value};
  if (intent_of(sent).motion == tmcl::Motion::turns)
    if (auto warning = warning_of_owner(call, axis)) warnings.push_back(std::move(*warning));
  auto result = co_await to_result(axis, choice, value);
  co_return parameter::Held{std::move(result), std::move(warnings)};
}

Answer<parameter::Store> store_parameter(Call& call, const parameter::Store& params) {
  return act_on_eeprom(call, params, &GatewayAxis::store);
}
Answer<parameter::Restore> restore_parameter(Call& call, const parameter::Restore& params) {
  return act_on_eeprom(call, params, &GatewayAxis::restore);
}

Answer<parameter::List> list_parameters(Call& call, const parameter::List& params) {
  const auto axis = co_await must(axis_of(call, params.axis));
  co_await must(axis->be_ready(), *axis);
  parameter::Parameters result;
  for (const auto& row : axis->parameters())
    result.parameters.push_back(tmcld::view_of(row, axis->unit()));
  co_return result;
}

}  // namespace tmcld::handlers

#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/quantity.hpp"
#include "api/state_json.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

boost::asio::awaitable<json::object> to_result(GatewayAxis& axis, ParameterChoice choice,
                                               ModuleValue value) {
  json::object result;
  result["parameter"] = nullptr;
  if (choice.row != nullptr) result["parameter"] = choice.row->name;
  result["number"] = choice.number;
  result["value"] = value.value;
  co_await add_in_unit(result, axis, choice.row, std::move(value));
  co_return result;
}

std::optional<RpcError> check_write(const ParameterChoice& choice) {
  if (choice.row == nullptr || choice.row->access != tmcl::Access::read) return std::nullopt;
  return param_error("read_only", "parameter",
                     "'" + std::string(choice.row->name) + "' can only be read");
}

}  // namespace

Answer get_parameter(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  auto& it = **axis;
  // Which names there are depends on the model.
  const auto ready = co_await it.be_ready();
  if (!ready) co_return tl::unexpected(call_error(ready.error(), it.name()));
  const auto choice = parameter_of(call, it);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto value = co_await it.get(choice->number, call.deadline());
  if (!value) co_return tl::unexpected(call_error(value.error(), it.name()));
  ModuleValue told{*value};
  auto result = co_await to_result(it, *choice, std::move(told));
  co_return result;
}

Answer set_parameter(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto choice = parameter_of(call, axis);
  if (!choice) co_return tl::unexpected(choice.error());
  auto complaint = check_write(*choice);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto value = co_await parameter_value_of(call, axis, *choice);
  if (!value) co_return tl::unexpected(value.error());
  const auto done = co_await axis.set(choice->number, value->value, ready->moves);
  if (!done) co_return tl::unexpected(call_error(done.error(), axis.name()));
  auto result = co_await to_result(axis, *choice, *value);
  co_return result;
}

Answer list_parameters(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto ready = co_await (*axis)->be_ready();
  if (!ready) co_return tl::unexpected(call_error(ready.error(), (*axis)->name()));
  json::array rows;
  for (const auto& row : (*axis)->parameters()) rows.push_back(to_json(row, (*axis)->unit()));
  json::object result;
  result["parameters"] = std::move(rows);
  co_return result;
}

}  // namespace tmcld::handlers

#include <boost/json/array.hpp>

#include "api/handlers.hpp"
#include "api/lookup.hpp"
#include "api/state_json.hpp"

namespace tmcld::handlers {
namespace {

namespace json = boost::json;

json::object to_result(const ParameterChoice& choice, std::int32_t value) {
  json::object result;
  result["parameter"] = nullptr;
  if (choice.row != nullptr) result["parameter"] = choice.row->name;
  result["number"] = choice.number;
  result["value"] = value;
  return result;
}

std::optional<RpcError> check_write(const ParameterChoice& choice, std::int32_t value) {
  if (choice.row == nullptr) return std::nullopt;
  if (choice.row->access == tmcl::Access::read) {
    return param_error("read_only", "parameter",
                       "'" + std::string(choice.row->name) + "' can only be read");
  }
  return check_range(choice.row, value, "value");
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
  co_return to_result(*choice, *value);
}

Answer set_parameter(Call& call) {
  const auto ready = co_await ready_to_move(call);
  if (!ready) co_return tl::unexpected(ready.error());
  auto& axis = *ready->axis;
  const auto choice = parameter_of(call, axis);
  if (!choice) co_return tl::unexpected(choice.error());
  const auto value = call.params.integer("value");
  auto complaint = check_write(*choice, value);
  if (complaint) co_return tl::unexpected(std::move(*complaint));
  const auto done = co_await axis.set(choice->number, value, ready->moves);
  if (!done) co_return tl::unexpected(call_error(done.error(), axis.name()));
  co_return to_result(*choice, value);
}

Answer list_parameters(Call& call) {
  const auto axis = axis_of(call);
  if (!axis) co_return tl::unexpected(axis.error());
  const auto ready = co_await (*axis)->be_ready();
  if (!ready) co_return tl::unexpected(call_error(ready.error(), (*axis)->name()));
  json::array rows;
  for (const auto& row : (*axis)->parameters()) rows.push_back(to_json(row));
  json::object result;
  result["parameters"] = std::move(rows);
  co_return result;
}

}  // namespace tmcld::handlers

#include "api/lookup.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "api/error.hpp"
#include "api/raw_name.hpp"
#include "api/suggest.hpp"

namespace tmcld {
namespace {

template <class List>
Error unknown(std::string_view kind, std::string_view param, const std::string& name,
              const List& known) {
  std::vector<std::string_view> names;
  for (const auto& one : known) names.push_back(one->name());
  const auto otherwise = "see " + std::string(kind) + ".list for what there is";
  return param_error("unknown_" + std::string(kind), param,
                     "there is no " + std::string(kind) + " '" + name + "'",
                     suggest(name, names, otherwise));
}

Result<std::shared_ptr<GatewayAxis>> find_axis(const Call& call, std::string_view param,
                                               const std::string& name) {
  if (is_raw_name(name)) return find_raw_axis(*call.gateway, param, name);
  auto axis = call.gateway->find_axis(name);
  if (axis) return axis;
  return tl::unexpected(unknown("axis", param, name, call.gateway->axes()));
}

Error unknown_parameter(const GatewayAxis& axis, std::string_view param, const std::string& name) {
  const auto rows = axis.parameters();
  if (rows.empty()) {
    return param_error("unknown_parameter", param,
                       "the model of axis '" + axis.name() + "' has no table of names",
                       "use the number of the parameter, from the module's manual");
  }
  std::vector<std::string_view> names;
  for (const auto& row : rows) names.push_back(row.name);
  return param_error("unknown_parameter", param, "there is no parameter '" + name + "'",
                     suggest(name, names, "see parameter.list for what there is"));
}

/// A name, or its number in digits.
Result<ParameterChoice> find_named(const GatewayAxis& axis, std::string_view param,
                                   const std::string& name) {
  const auto rows = axis.parameters();
  if (const auto* row = find_parameter(rows, name)) return ParameterChoice{row->number, row};
  const auto number = as_number(name);
  if (!number) return tl::unexpected(unknown_parameter(axis, param, name));
  return ParameterChoice{*number, find_parameter(rows, *number)};
}

}  // namespace

std::optional<std::uint8_t> as_number(const std::string& text) {
  std::uint8_t number = 0;
  const auto* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc{} || result.ptr != end) return std::nullopt;
  return number;
}

Result<std::shared_ptr<GatewayAxis>> axis_of(const Call& call, const std::string& name) {
  return find_axis(call, "axis", name);
}

Task<ReadyToMove> ready_to_move(const Call& call, const std::string& name, Deadline deadline) {
  const auto axis = co_await must(axis_of(call, name));
  ReadyToMove ready{axis, axis->begin_movement(call.permit, deadline)};
  co_await must(axis->be_ready(), *axis);
  co_return ready;
}

Result<std::vector<std::shared_ptr<GatewayAxis>>> axes_of(const Call& call,
                                                          const AxisNames& names) {
  const auto all = call.gateway->axes();
  if (!names) return std::vector(all.begin(), all.end());
  std::vector<std::shared_ptr<GatewayAxis>> chosen;
  for (const auto& name : *names) {
    auto axis = find_axis(call, "axes", name);
    if (!axis) return tl::unexpected(std::move(axis.error()));
    if (std::ranges::find(chosen, *axis) == chosen.end()) chosen.push_back(std::move(*axis));
  }
  return chosen;
}

Result<std::shared_ptr<GatewayBus>> bus_of(const Call& call, const std::string& name) {
  if (auto* bus = call.gateway->find_bus(name)) return bus->shared_from_this();
  return tl::unexpected(unknown("bus", "bus", name, call.gateway->buses()));
}

Result<ParameterChoice> parameter_of(const api::NameOrNumber& given, const GatewayAxis& axis) {
  const auto rows = axis.parameters();
  if (const auto* number = std::get_if<std::int32_t>(&given.said)) {
    const auto byte = static_cast<std::uint8_t>(*number);
    return ParameterChoice{byte, find_parameter(rows, byte)};
  }
  return find_named(axis, "parameter", std::get<std::string>(given.said));
}

Result<std::vector<std::uint8_t>> parameters_of(const std::vector<std::string>& given,
                                                std::string_view param, const GatewayAxis& axis) {
  std::vector<std::uint8_t> numbers;
  for (const auto& name : given) {
    auto choice = find_named(axis, param, name);
    if (!choice) return tl::unexpected(std::move(choice.error()));
    if (std::ranges::find(numbers, choice->number) == numbers.end())
      numbers.push_back(choice->number);
  }
  return numbers;
}

std::optional<Error> check_range(const tmcl::ParameterInfo* row, std::int64_t value,
                                 std::string_view param) {
  // Where the range depends on the unit mode, the module is left to judge.
  if (row == nullptr || row->scale != tmcl::Scale::fixed) return std::nullopt;
  if (value >= row->minimum && value <= row->maximum) return std::nullopt;
  return param_error("out_of_range", param,
                     std::to_string(value) + " is outside " + std::to_string(row->minimum) + ".." +
                         std::to_string(row->maximum) + ", the range of " + std::string(row->name),
                     row->unit == "code" ? std::string(row->meaning) : std::string());
}

std::optional<std::string> warning_of_owner(const Call& call, const GatewayAxis& axis,
                                            std::string_view does) {
  const auto holder = axis.holder();
  const bool owns = axis.turns() && holder.lease == 0 && holder.client != 0 &&
                    holder.client == call.permit.client;
  if (!owns) return std::nullopt;
  return "axis '" + axis.name() + "' " + std::string(does) +
         " for this connection, and is stopped when that ends; 'tmclctl rotate " + axis.name() +
         " SPEED --unattended', or axis.rotate with 'unattended', lets it turn on";
}

}  // namespace tmcld

#include "tmcl/parameter.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "core/parameter_row.hpp"

namespace tmcl {
namespace {

using Table = std::vector<ParameterInfo>;
using Tables = std::vector<Table>;  // in the order of the models

Table select(std::span<const ParameterRow> rows, ModelSet model) {
  Table table;
  for (const auto& row : rows) {
    if ((row.models & model) != 0) table.push_back(row.info);
  }
  return table;
}

std::span<const ParameterRow> axis_rows(Family family) {
  switch (family) {
    case Family::tmc429: return tmc429_axis_rows();
    case Family::tmc457: return tmc457_axis_rows();
    case Family::sixpoint: return sixpoint_axis_rows();
    case Family::tmc4361: return tmc4361_axis_rows();
    case Family::firmware: return firmware_axis_rows();
  }
  return {};
}

Tables make_axis_tables() {
  Tables tables;
  for (std::size_t i = 0; i < all_models.size(); ++i) {
    tables.push_back(select(axis_rows(all_models[i].family), set_of(i)));
  }
  return tables;
}

Tables make_global_tables() {
  Tables tables;
  for (std::size_t i = 0; i < all_models.size(); ++i) {
    tables.push_back(select(global_rows(), set_of(i)));
  }
  return tables;
}

std::span<const ParameterInfo> table_of(const Model& model, const Tables& tables) {
  const auto* row = find_model(model.number);
  if (row == nullptr) return {};
  return tables[static_cast<std::size_t>(row - all_models.data())];
}

// Bank 3.
constexpr int timers = 3;
constexpr int first_stop_switch = 27;
constexpr int stop_switches = 12;
constexpr int first_input = 39;
constexpr int inputs = 8;

constexpr std::int32_t least = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t greatest = std::numeric_limits<std::int32_t>::max();

constexpr bool lies_in(int number, int first, int count) {
  return number >= first && number < first + count;
}

// Some models keep settings for stop switches and inputs that they do not have: PyTrinamic's lists
// name such on the TMCM-1110 and TMCM-1240. So all are kept on all models.
std::optional<GlobalRange> interrupt_range(std::uint8_t number) {
  constexpr GlobalRange period{Access::read_write, true, 0, greatest, 0};
  constexpr GlobalRange edge{Access::read_write, true, 0, 3, 0};
  if (lies_in(number, 0, timers)) return period;
  const bool has_edge =
      lies_in(number, first_stop_switch, stop_switches) || lies_in(number, first_input, inputs);
  return has_edge ? std::optional(edge) : std::nullopt;
}

std::optional<GlobalRange> parameter_range(const Model& model, std::uint8_t number) {
  const auto* row = find_parameter(global_parameters(model), number);
  if (row == nullptr) return std::nullopt;
  return GlobalRange{row->access, row->stored, row->minimum, row->maximum, row->initial};
}

}  // namespace

std::span<const ParameterInfo> axis_parameters(const Model& model) {
  static const auto tables = make_axis_tables();
  return table_of(model, tables);
}

std::span<const ParameterInfo> global_parameters(const Model& model) {
  static const auto tables = make_global_tables();
  return table_of(model, tables);
}

std::optional<GlobalRange> global_range(const Model& model, std::uint8_t bank,
                                        std::uint8_t number) {
  switch (bank) {
    case global_bank::parameters: return parameter_range(model, number);
    case global_bank::user_variables:
      return GlobalRange{Access::read_write, number < kept_user_variables, least, greatest, 0};
    case global_bank::interrupts: return interrupt_range(number);
    default: return std::nullopt;
  }
}

const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::uint8_t number) {
  const auto row = std::ranges::lower_bound(table, number, {}, &ParameterInfo::number);
  return row != table.end() && row->number == number ? &*row : nullptr;
}

const ParameterInfo* find_parameter(std::span<const ParameterInfo> table, std::string_view name) {
  const auto row =
      std::ranges::find_if(table, [&](const ParameterInfo& info) { return goes_by(info, name); });
  return row != table.end() ? &*row : nullptr;
}

}  // namespace tmcl

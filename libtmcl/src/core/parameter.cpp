#include "tmcl/parameter.hpp"

#include <algorithm>
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

}  // namespace

std::span<const ParameterInfo> axis_parameters(const Model& model) {
  static const auto tables = make_axis_tables();
  return table_of(model, tables);
}

std::span<const ParameterInfo> global_parameters(const Model& model) {
  static const auto tables = make_global_tables();
  return table_of(model, tables);
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

/// How the tables of parameters are written: one row a parameter, or several where models of one
/// family differ.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/model_set.hpp"
#include "core/text.hpp"
#include "tmcl/parameter.hpp"
#include "tmcl/parameter_number.hpp"

namespace tmcl {

struct ParameterRow {
  ParameterInfo info;
  ModelSet models = every_model;  ///< Of those whose table this is.
};

namespace row {
inline constexpr auto r = Access::read;
inline constexpr auto rw = Access::read_write;
inline constexpr std::int32_t x_least = std::numeric_limits<std::int32_t>::min();
inline constexpr std::int32_t x_greatest = std::numeric_limits<std::int32_t>::max();
}  // namespace row

constexpr bool goes_by(const ParameterInfo& info, std::string_view name) {
  if (text::equal_as_name(info.name, name)) return true;
  return std::ranges::any_of(info.aliases, [&](std::string_view alias) {
    return !alias.empty() && text::equal_as_name(alias, name);
  });
}

constexpr bool share_a_name(const ParameterInfo& a, const ParameterInfo& b) {
  if (goes_by(b, a.name)) return true;
  return std::ranges::any_of(
      a.aliases, [&](std::string_view alias) { return !alias.empty() && goes_by(b, alias); });
}

constexpr bool has_sane_range(const ParameterRow& row) {
  return row.info.minimum <= row.info.initial && row.info.initial <= row.info.maximum;
}

/// Sorted by number, and on no model a number or a name twice.
constexpr bool is_sound(std::span<const ParameterRow> rows, ModelSet models) {
  if (!std::ranges::all_of(rows, has_sane_range)) return false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (rows[k].info.number > rows[i].info.number) return false;
      if ((rows[k].models & rows[i].models & models) == 0) continue;
      if (rows[k].info.number == rows[i].info.number) return false;
      if (share_a_name(rows[k].info, rows[i].info)) return false;
    }
  }
  return true;
}

/// Whether number_of() gives the numbers of this table, for all names that it knows.
constexpr bool agrees_with_numbers(std::span<const ParameterRow> rows, Family family) {
  for (const auto& listed : numbered::list) {
    const bool is_here = (listed.families & set_of(family)) != 0;
    bool found = false;
    for (const auto& row : rows) {
      if (row.info.name != listed.name) continue;
      if (is_here && row.info.number != listed.number) return false;
      found = true;
    }
    const bool is_known = numbered::find(family, listed.name).has_value();
    if (found != is_known) return false;
  }
  return true;
}

/// The same, for a table of axis parameters.
constexpr bool is_sound(std::span<const ParameterRow> rows, Family family) {
  return is_sound(rows, models_of(family)) && agrees_with_numbers(rows, family);
}

std::span<const ParameterRow> tmc429_axis_rows();
std::span<const ParameterRow> tmc457_axis_rows();
std::span<const ParameterRow> sixpoint_axis_rows();
std::span<const ParameterRow> tmc4361_axis_rows();
std::span<const ParameterRow> firmware_axis_rows();
std::span<const ParameterRow> global_rows();

}  // namespace tmcl

#include "names.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "tmcl/nearest.hpp"

namespace tmclctl {
namespace {

template <class Integer>
std::optional<Integer> parse_whole(std::string_view text) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

constexpr std::uint16_t greatest_address = 2047;

template <class Condition>
bool in_all_families(Condition holds) {
  return std::ranges::all_of(
      tmcl::families, [&](tmcl::Family family) { return holds(tmcl::axis_parameters(family)); });
}

bool is_nothing_else(std::string_view name, std::uint8_t number) {
  return in_all_families([&](auto table) {
    const auto* row = find_parameter(table, name);
    return row == nullptr || row->number == number;
  });
}

bool has_no_other_name(const tmcl::ParameterInfo& info) {
  return in_all_families([&](auto table) {
    const auto* row = find_parameter(table, info.number);
    return row == nullptr || row->name == info.name;
  });
}

void add_common(std::vector<tmcl::ParameterInfo>& common, tmcl::ParameterInfo row) {
  if (std::ranges::count(common, row.number, &tmcl::ParameterInfo::number) != 0) return;
  if (!has_no_other_name(row) || !is_nothing_else(row.name, row.number)) return;
  for (auto& alias : row.aliases) {
    if (!is_nothing_else(alias, row.number)) alias = {};
  }
  common.push_back(row);
}

std::vector<tmcl::ParameterInfo> make_common() {
  std::vector<tmcl::ParameterInfo> common;
  for (const auto family : tmcl::families) {
    for (const auto& row : tmcl::axis_parameters(family)) add_common(common, row);
  }
  std::ranges::sort(common, {}, &tmcl::ParameterInfo::number);
  return common;
}

}  // namespace

Attempt<tmcl::AxisAddress> parse_axis_address(std::string_view text) {
  const auto slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto address = parse_whole<std::uint16_t>(text.substr(0, slash));
    const auto motor = parse_whole<std::uint8_t>(text.substr(slash + 1));
    if (address && motor && *address <= greatest_address) {
      return tmcl::AxisAddress{tmcl::ModuleAddress{*address}, *motor};
    }
  }
  return tl::unexpected(usage_failure("unknown_axis", fmt::format("'{}' is no axis", text),
                                      "With --direct an axis is ADDRESS/MOTOR, such as 1/0 for "
                                      "motor 0 of module 1; names need a running tmcld"));
}

std::string axis_name(tmcl::AxisAddress axis) {
  return fmt::format("{}/{}", number(axis.module), axis.motor);
}

Attempt<ParameterName> parse_parameter(std::span<const tmcl::ParameterInfo> table,
                                       std::string_view text) {
  if (const auto number = parse_whole<std::uint8_t>(text)) {
    const auto* row = find_parameter(table, *number);
    return ParameterName{*number,
                         row != nullptr ? std::string(row->name) : std::to_string(*number)};
  }
  if (const auto* row = find_parameter(table, text))
    return ParameterName{row->number, std::string(row->name)};
  std::vector<std::string_view> names;
  for (const auto& row : table) {
    names.push_back(row.name);
    for (const auto alias : row.aliases) {
      if (!alias.empty()) names.push_back(alias);
    }
  }
  auto hint = tmcl::did_you_mean(text, names);
  if (!hint.empty()) hint.erase(0, 1);
  hint += hint.empty()
              ? "'tmclctl params AXIS' lists the names; a number from 0 to 255 will do, too"
              : " 'tmclctl params AXIS' lists all names";
  return tl::unexpected(
      usage_failure("unknown_parameter", fmt::format("there is no parameter '{}'", text), hint));
}

std::span<const tmcl::ParameterInfo> common_parameters() {
  static const auto common = make_common();
  return common;
}

}  // namespace tmclctl

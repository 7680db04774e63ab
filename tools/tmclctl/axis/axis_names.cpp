#include "axis_names.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <map>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "command_line/form.hpp"
#include "tmcl/spelling.hpp"

namespace tmclctl {
namespace {

template <class Integer>
std::optional<Integer> parse_whole(std::string_view text) {
  Integer value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

using Tables = std::vector<std::span<const tmcl::ParameterInfo>>;

Tables all_tables(std::span<const tmcl::ParameterInfo> (*parameters)(const tmcl::Model&)) {
  Tables tables;
  for (const auto& model : tmcl::models()) tables.push_back(parameters(model));
  return tables;
}

/// As the tables compare names.
std::string plain(std::string_view name) {
  std::string plain;
  for (const auto c : name) {
    if (c != '_' && c != '-' && c != ' ') plain += static_cast<char>(std::tolower(c));
  }
  return plain;
}

/// Which parameters mean the same wherever they exist, and which names do.
class Common {
 public:
  explicit Common(const Tables& tables) {
    for (const auto table : tables) {
      for (const auto& row : table) note(row);
    }
    for (const auto table : tables) {
      for (const auto& row : table) add(row);
    }
    std::ranges::sort(rows_, {}, &tmcl::ParameterInfo::number);
  }
  std::span<const tmcl::ParameterInfo> rows() const { return rows_; }

 private:
  void note(const tmcl::ParameterInfo& row) {
    names_[row.number].insert(row.name);
    numbers_[plain(row.name)].insert(row.number);
    for (const auto alias : row.aliases) numbers_[plain(alias)].insert(row.number);
  }
  bool is_one_thing(std::string_view name) const { return numbers_.at(plain(name)).size() == 1; }
  void add(tmcl::ParameterInfo row) {
    if (std::ranges::count(rows_, row.number, &tmcl::ParameterInfo::number) != 0) return;
    if (names_[row.number].size() != 1 || !is_one_thing(row.name)) return;
    for (auto& alias : row.aliases) {
      if (!is_one_thing(alias)) alias = {};
    }
    rows_.push_back(row);
  }

  std::array<std::set<std::string_view>, 256> names_;
  std::map<std::string, std::set<std::uint8_t>> numbers_;
  std::vector<tmcl::ParameterInfo> rows_;
};

}  // namespace

std::optional<AxisPlace> parse_axis_place(std::string_view text) {
  const auto slash = text.rfind('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const auto module = parse_module(text.substr(0, slash));
  const auto motor = parse_whole<std::uint8_t>(text.substr(slash + 1));
  if (!module || !motor) return std::nullopt;
  return AxisPlace{*module, *motor};
}

std::string axis_name(tmcl::AxisAddress axis) {
  return fmt::format("{}/{}", number(axis.module), axis.motor);
}

Result<ModuleName> parse_module(std::string_view text) {
  const auto colon = text.rfind(':');
  const auto digits = colon == std::string_view::npos ? text : text.substr(colon + 1);
  ModuleName name;
  if (colon != std::string_view::npos) name.bus = text.substr(0, colon);
  constexpr unsigned greatest = 2047;
  const auto* end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, name.address);
  if (read.ec == std::errc{} && read.ptr == end && name.address <= greatest) return name;
  return tl::unexpected(usage_error(
      "bad_module", fmt::format("'{}' names no module", text),
      "A module is its address, 0 to 2047, or BUS:ADDRESS where tmcld has several buses"));
}

Result<ParameterName> parse_parameter(std::span<const tmcl::ParameterInfo> table,
                                      std::string_view text) {
  if (const auto number = parse_number<std::uint8_t>(text)) {
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
      usage_error("unknown_parameter", fmt::format("there is no parameter '{}'", text), hint));
}

Result<const tmcl::Model*> parse_model(std::string_view name) {
  if (const auto* model = tmcl::find_model(name)) return model;
  std::vector<std::string_view> names;
  for (const auto& model : tmcl::models()) names.push_back(model.name);
  auto hint = tmcl::did_you_mean(name, names);
  if (!hint.empty()) hint.erase(0, 1);
  hint += hint.empty() ? "'tmclctl models' lists those that are known"
                       : " 'tmclctl models' lists all that are known";
  return tl::unexpected(
      usage_error("unknown_model", fmt::format("there is no model '{}'", name), hint));
}

std::span<const tmcl::ParameterInfo> common_parameters() {
  static const Common common(all_tables(tmcl::axis_parameters));
  return common.rows();
}

std::span<const tmcl::ParameterInfo> common_global_parameters() {
  static const Common common(all_tables(tmcl::global_parameters));
  return common.rows();
}

}  // namespace tmclctl

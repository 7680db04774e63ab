#include "print.hpp"

#include <algorithm>
#include <utility>

#include "tmcl/json_text.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

constexpr std::size_t column_gap = 2;

}  // namespace

void print_json(const json::object& document, Output& output) {
  output.out << tmcl::json_text(document) << std::endl;
}

void warn(std::string_view text, Output& output) {
  output.err << "tmclctl: warning: " << text << '\n';
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const auto& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

void warn(const Warnings& warnings, Output& output) {
  for (const auto& warning : warnings) warn(warning, output);
}

Table::Table(std::vector<std::string> headings) { rows_.push_back(std::move(headings)); }

void Table::add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }

void Table::print(std::ostream& out) const {
  std::vector<std::size_t> widths(rows_.front().size());
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i] + std::string(widths[i] - row[i].size() + column_gap, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out << line << '\n';
  }
}

std::string position_text(const AxisReading& reading, bool internal) {
  return shown(internal ? std::nullopt : in_unit(reading.position, reading.unit),
               reading.position_microsteps);
}

std::string target_text(const AxisReading& reading, bool internal) {
  return shown(internal ? std::nullopt : in_unit(reading.target, reading.unit),
               reading.target_microsteps);
}

std::string velocity_text(const AxisReading& reading, bool internal) {
  return shown(internal ? std::nullopt : in_unit_a_second(reading.velocity, reading.unit),
               reading.velocity_internal);
}

std::string_view access_text(bool writable, bool stored) {
  if (!writable) return "R";
  return stored ? "RWE" : "RW";
}

std::string name_of(const tmcl::api::parameter::Number& parameter) {
  return parameter.parameter.value_or(std::to_string(parameter.number));
}

json::object to_json(const std::string& axis, const tmcl::api::parameter::Value& value) {
  json::object object{{"axis", axis},
                      {"parameter", name_of(value)},
                      {"number", value.number},
                      {"value", value.value}};
  if (const auto shown = in_unit(value.value_in_unit, value.unit)) {
    object["value_in_unit"] = shown->value;
    object["unit"] = shown->unit;
  }
  return object;
}

}  // namespace tmclctl

#include "print.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "command_line/method_words.hpp"
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
  output.err << "tmclctl: warning: " << with_gateway(text, output.gateway) << '\n';
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const auto& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

void warn(const Warnings& warnings, Output& output) {
  for (const auto& warning : warnings) warn(warning, output);
}

std::string alarming(std::string_view text, const Screen& screen) {
  constexpr std::string_view red = "\x1b[31m";
  constexpr std::string_view usual = "\x1b[0m";
  std::string shown(text);
  if (screen.colour) shown.insert(0, red).append(usual);
  return shown;
}

// ---- tables -------------------------------------------------------------------------------------

namespace {

using Cells = Table::Cells;
using Widths = std::vector<std::size_t>;

/// Less of a column says nothing.
constexpr std::size_t least_column_width = 12;

Widths widths_of(const std::vector<Cells>& rows) {
  Widths widths(rows.front().size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

std::string line_of(const Cells& row, const Widths& widths) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i)
    line +=
        row[i] + std::string(std::max(widths[i], row[i].size()) - row[i].size() + column_gap, ' ');
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

/// Cuts cells of the widest column until lines are no longer than `width`.
void fit(std::vector<Cells>& rows, std::size_t width, std::string_view dots) {
  const auto widths = widths_of(rows);
  std::size_t whole = 0;
  for (const auto one : widths) whole += one + column_gap;
  whole -= column_gap;
  if (whole <= width) return;
  const auto widest = static_cast<std::size_t>(std::ranges::max_element(widths) - widths.begin());
  const auto too_long = whole - width;
  const auto room = widths[widest] > too_long + least_column_width ? widths[widest] - too_long
                                                                   : least_column_width;
  for (auto& row : rows) {
    if (row.size() <= widest || row[widest].size() <= room) continue;
    row[widest].resize(room - std::min(room, dots.size()));
    row[widest] += dots;
  }
}

bool is_same_word(std::string_view one, std::string_view other) {
  return std::ranges::equal(
      one, other, {}, [](unsigned char letter) { return std::tolower(letter); },
      [](unsigned char letter) { return std::tolower(letter); });
}

/// Which columns are shown; names of others are told.
std::vector<std::size_t> chosen(const Cells& headings, const std::vector<std::string>& names,
                                Output& output) {
  std::vector<std::size_t> columns;
  for (const auto& name : names) {
    const auto found = std::ranges::find_if(
        headings, [&](const std::string& heading) { return is_same_word(heading, name); });
    if (found == headings.end()) {
      warn("there is no column '" + name + "'; there are: " + joined(headings), output);
    } else {
      columns.push_back(static_cast<std::size_t>(found - headings.begin()));
    }
  }
  return columns;
}

void print_as_tsv(const std::vector<Cells>& rows, std::ostream& out) {
  for (const auto& row : rows) {
    std::string line;
    for (const auto& cell : row) line += (&cell == row.data() ? "" : "\t") + cell;
    out << line << '\n';
  }
}

}  // namespace

Table::Table(Cells headings) { add(std::move(headings)); }

void Table::add(Cells cells, bool wrong) {
  rows_.push_back(std::move(cells));
  wrong_.push_back(wrong);
}

void Table::print(std::ostream& out) const {
  const auto widths = widths_of(rows_);
  for (const auto& row : rows_) out << line_of(row, widths) << '\n';
}

void Table::print(Output& output) const {
  auto rows = rows_;
  if (const auto& names = output.tables.columns; !names.empty()) {
    const auto columns = chosen(rows_.front(), names, output);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows[i].clear();
      for (const auto column : columns)
        rows[i].push_back(column < rows_[i].size() ? rows_[i][column] : std::string());
    }
  }
  if (output.tables.tsv) return print_as_tsv(rows, output.out);
  const auto& screen = output.out_screen;
  if (screen.terminal && !output.tables.wide)
    fit(rows, static_cast<std::size_t>(screen.width), screen.utf8 ? "\u2026" : "...");
  const auto widths = widths_of(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto line = line_of(rows[i], widths);
    output.out << (wrong_[i] ? alarming(line, screen) : line) << '\n';
  }
}

void GrowingTable::add(const Cells& row, std::ostream& out) {
  if (rows_++ == 0) {
    for (std::size_t i = 0; i < headings_.size(); ++i)
      widths_[i] = std::max(widths_[i], headings_[i].size());
    out << line_of(headings_, widths_) << '\n';
  }
  out << line_of(row, widths_) << std::endl;
}

// ---- readings -----------------------------------------------------------------------------------

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

std::string remark_on(const AxisReading& reading) {
  if (!reading.faults.empty()) return joined(reading.faults);
  if (reading.latched) return "latched";
  if (reading.moving) return "moving";
  if (reading.stop_cause) return "stopped: " + *reading.stop_cause;
  return reading.position_reached ? "at target" : "standing";
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

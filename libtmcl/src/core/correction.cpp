#include "tmcl/correction.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tmcl/plain_number.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl {
namespace {

using Row = Correction::Row;

constexpr std::string_view blanks = " \t\r";

std::string_view without_comment(std::string_view line) {
  line = line.substr(0, line.find('#'));
  const auto first = line.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return line.substr(first, line.find_last_not_of(blanks) - first + 1);
}

bool names_columns(std::string_view line) {
  const auto letter = static_cast<unsigned char>(line.front());
  return letter == '"' || (letter | 0x20U) - unsigned{'a'} < 26U;
}

/// Takes a number from the front of the text.
std::optional<double> take_number(std::string_view& text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || !std::isfinite(number)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

void skip(std::string_view& text, std::string_view characters) {
  text.remove_prefix(std::min(text.find_first_not_of(characters), text.size()));
}

std::optional<Row> row_of(std::string_view line) {
  const auto counted = take_number(line);
  const auto before = line.size();
  skip(line, blanks);
  if (line.starts_with(',')) line.remove_prefix(1);
  skip(line, blanks);
  if (!counted || line.size() == before) return std::nullopt;
  const auto actual = take_number(line);
  if (!actual || !line.empty()) return std::nullopt;
  return Row{*counted, *actual};
}

/// What keeps a row from following another one; empty if nothing does.
std::string objection_to(Row row, Row before) {
  const double by_steps = row.counted - before.counted;
  const double really = row.actual - before.actual;
  if (!(by_steps > 0)) return "the first column must rise from line to line";
  if (std::abs(really - by_steps) <= Correction::most_difference * by_steps) return {};
  return fmt::format(
      "from the line before, the axis goes {} by its steps, and really {}: that is more than "
      "{:.0f} "
      "% apart, so it is its scale that is wrong, or the table",
      plain_number(by_steps, 6), plain_number(really, 6), 100 * Correction::most_difference);
}

/// Along the line through the two rows on either side, or away from the first or the last one.
double read_off(const std::vector<Row>& rows, double value, double Row::*from, double Row::*to) {
  const auto above = std::ranges::upper_bound(rows, value, {}, from);
  if (above == rows.begin()) return value + (rows.front().*to - rows.front().*from);
  if (above == rows.end()) return value + (rows.back().*to - rows.back().*from);
  const auto& one = *std::prev(above);
  const auto& other = *above;
  const double part = (value - one.*from) / (other.*from - one.*from);
  return one.*to + part * (other.*to - one.*to);
}

}  // namespace

tl::expected<Correction, TextProblem> Correction::of(std::string_view text) {
  std::vector<Row> rows;
  bool may_name_columns = true;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto line = without_comment(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    const bool is_heading = std::exchange(may_name_columns, false) && names_columns(line);
    if (is_heading) continue;
    const auto problem = [&](std::string message) {
      return tl::unexpected(TextProblem{number, 0, std::move(message)});
    };
    const auto row = row_of(line);
    if (!row)
      return problem(quoted(line) +
                     " is not two numbers: where the axis is by its steps, and where it really is");
    if (!rows.empty())
      if (auto why = objection_to(*row, rows.back()); !why.empty()) return problem(std::move(why));
    if (rows.size() == most_rows) return problem(fmt::format("more than {} rows", most_rows));
    rows.push_back(*row);
  }
  if (rows.size() < 2)
    return tl::unexpected(TextProblem{0, 0, "a correction needs two rows at least"});
  return Correction(std::move(rows));
}

double Correction::actual(double counted) const {
  return read_off(rows_, counted, &Row::counted, &Row::actual);
}

double Correction::counted(double actual) const {
  return read_off(rows_, actual, &Row::actual, &Row::counted);
}

Correction Correction::in_unit(double count) const {
  auto rows = rows_;
  for (auto& row : rows) row = {row.counted * count, row.actual * count};
  return Correction(std::move(rows));
}

}  // namespace tmcl

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "plan/text_cursor.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

constexpr std::string_view time_name = "t";
constexpr std::string_view speed_name = "speed";

constexpr bool is_of_a_name(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; }

/// One row of a table, cell by cell.
class RowReader {
 public:
  explicit RowReader(std::string_view row) : cursor_(row) {}

  /// Whether there is another cell, which then begins at column().
  bool next() {
    if (!first_ && !cursor_.take(',')) return false;
    first_ = false;
    cursor_.skip_blanks();
    column_ = cursor_.column();
    return true;
  }
  std::size_t column() const { return column_; }
  bool is_empty() const { return cursor_.at_end() || cursor_.peek() == ','; }
  std::string_view name() { return cursor_.take_while(is_of_a_name); }
  std::optional<double> number() { return cursor_.take_number(); }
  /// What is shown of a cell that cannot be read.
  std::string word() const { return is_empty() ? "" : shown(cursor_.word()); }
  /// Whether nothing but blanks is left of the cell.
  bool cell_ends() {
    cursor_.skip_blanks();
    return is_empty();
  }

 private:
  TextCursor cursor_;
  std::size_t column_ = 0;
  bool first_ = true;
};

class CsvReader {
 public:
  tl::expected<Path, TextProblems> read(std::string_view text) {
    for_each_line(text, problems_, [&](std::string_view line, std::size_t number) {
      const auto content = line.find_first_not_of(" \t");
      if (content == std::string_view::npos || line[content] == '#') return true;
      number_ = number;
      return columns_.empty() ? read_names(line) : read_numbers(line);
    });
    if (problems_.empty() && !started_)
      problems_.add(number_ + 1, 0,
                    columns_.empty() ? "there is no row of names" : "there is no row of numbers");
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    return std::move(path_);
  }

 private:
  bool wrong(std::size_t column, std::string message) {
    problems_.add(number_, column, std::move(message));
    return true;
  }

  /// Without its columns nothing of a table can be read.
  bool read_names(std::string_view line) {
    RowReader row(line);
    while (row.next()) {
      const std::string name(row.name());
      if (name.empty() || !row.cell_ends()) {
        const bool semicolons = line.find(';') != std::string_view::npos;
        wrong(row.column(), fmt::format("'{}{}' is no name of a column{}", name, row.word(),
                                        semicolons ? "; commas must stand between them" : ""));
        return false;
      }
      if (std::ranges::find(columns_, name) != columns_.end()) {
        wrong(row.column(), fmt::format("there are two columns '{}'", name));
        return false;
      }
      columns_.push_back(name);
      if (name != time_name && name != speed_name) path_.axes.push_back(name);
    }
    return names_are_good();
  }

  bool names_are_good() {
    timed_ = std::ranges::find(columns_, time_name) != columns_.end();
    const bool has_speed = std::ranges::find(columns_, speed_name) != columns_.end();
    std::string problem;
    if (path_.axes.empty()) problem = "no column is an axis";
    if (path_.axes.size() > most_axes)
      problem = fmt::format("there are {} axes; {} at most", path_.axes.size(), most_axes);
    if (timed_ && has_speed) problem = "t and speed exclude each other";
    if (problem.empty()) return true;
    wrong(0, problem);
    return false;
  }

  bool read_numbers(std::string_view line) {
    RowReader row(line);
    LineTo next;
    next.line = number_;
    double time = 0;
    std::size_t axis = 0;
    std::size_t i = 0;
    for (; row.next(); ++i) {
      if (i == columns_.size())
        return wrong(row.column(), fmt::format("there are more than {} cells", i));
      const auto& name = columns_[i];
      if (name == speed_name && !started_ && row.is_empty()) continue;
      const auto shown_word = row.word();
      const auto value = row.number();
      if (!value || !row.cell_ends())
        return wrong(row.column(), fmt::format("'{}' is no number", shown_word));
      if (name == time_name) {
        if (started_ && *value <= time_) return wrong(row.column(), "t does not ascend");
        if (!std::isfinite(*value - time_)) return wrong(row.column(), "t leaps too far");
        time = *value;
      } else if (name == speed_name) {
        if (started_ && *value <= 0) return wrong(row.column(), "speed must be above 0");
        next.feed = *value;
      } else {
        next.target[axis++] = *value;
      }
    }
    if (i < columns_.size())
      return wrong(0, fmt::format("the row has {} of {} cells", i, columns_.size()));
    return add(std::move(next), time);
  }

  bool add(LineTo next, double time) {
    if (started_) {
      if (timed_) next.duration = time - time_;
      if (path_.elements.size() == most_elements) {
        wrong(0, fmt::format("the path is too long; {} elements at most", most_elements));
        return false;
      }
      if (timed_ || next.target != at_) path_.elements.emplace_back(next);
    } else {
      path_.start = next.target;
    }
    started_ = true;
    at_ = next.target;
    time_ = time;
    return true;
  }

  ProblemList problems_;
  Path path_;
  std::vector<std::string> columns_;
  std::size_t number_ = 0;
  bool timed_ = false;
  bool started_ = false;
  Point at_{};
  double time_ = 0;
};

}  // namespace

Reading read_csv(std::string_view text) { return CsvReader().read(text); }

}  // namespace tmcl::plan::path_file

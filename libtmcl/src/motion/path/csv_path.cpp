#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "motion/path/text_cursor.hpp"
#include "tmcl/plan/path_file.hpp"

namespace tmcl::plan::path_file {
namespace {

constexpr std::string_view time_name = "t";
constexpr std::string_view speed_name = "speed";
constexpr std::array<std::string_view, 4> names_of_time{"t", "time", "t_s", "time_s"};
// What programs call these columns, with or without a unit behind it.
constexpr std::array<std::string_view, 5> like_time{"time", "timestamp", "t", "seconds", "elapsed"};
constexpr std::array<std::string_view, 6> like_speed{"speed",    "velocity", "v",
                                                     "feedrate", "feed",     "f"};

constexpr bool is_of_a_name(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; }

/// Whether `name` is `wanted`, or that and something of its own behind it: time_ms, feed-rate.
/// Behind a letter a digit is an axis: t1.
bool begins_as(std::string_view name, std::string_view wanted) {
  if (!name.starts_with(wanted)) return false;
  if (name.size() == wanted.size()) return true;
  const char next = name[wanted.size()];
  return next == '_' || next == '-' || (wanted.size() > 1 && is_digit(next));
}

/// One row of a table, cell by cell. A cell may stand in quotes.
class RowReader {
 public:
  explicit RowReader(std::string_view row) : cursor_(row) {}

  /// Whether there is another cell, which then begins at column().
  bool next() {
    if (!first_ && !cursor_.take(',')) return false;
    first_ = false;
    cursor_.skip_blanks();
    column_ = cursor_.column();
    cell_ = cursor_.peek() == '"' ? quoted() : plain();
    return true;
  }
  std::size_t column() const { return column_; }
  bool is_empty() const { return cell_.empty(); }
  /// What stands in the cell, if that is a name; otherwise nothing.
  std::string_view name() const {
    return std::ranges::all_of(cell_, is_of_a_name) ? cell_ : std::string_view{};
  }
  /// The same of a number.
  std::optional<double> number() const {
    TextCursor cursor(cell_);
    const auto value = cursor.take_number();
    return cursor.at_end() ? value : std::nullopt;
  }
  std::string shown_cell() const { return shown(cell_); }

 private:
  static std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  std::string_view plain() {
    return trimmed(cursor_.take_while([](char c) { return c != ','; }));
  }
  // As RFC 4180 has it; a quote within the cell stays doubled, since no name or number has one.
  std::string_view quoted() {
    const auto text = cursor_.rest();
    auto end = text.find('"', 1);
    while (end != std::string_view::npos && text.substr(end + 1).starts_with('"'))
      end = text.find('"', end + 2);
    if (end == std::string_view::npos) return plain();
    cursor_.skip(end + 1);
    const auto behind = plain();
    return behind.empty() ? trimmed(text.substr(1, end - 1)) : text.substr(0, end + 1);
  }

  TextCursor cursor_;
  std::string_view cell_;
  std::size_t column_ = 0;
  bool first_ = true;
};

class CsvReader {
 public:
  tl::expected<Path, TextProblems> read(std::string_view text) {
    for_each_line(text, problems_, [&](std::string_view line, std::size_t number) {
      const auto content = std::ranges::find_if_not(line, is_blank);
      if (content == line.end() || *content == '#') return true;
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
    while (row.next()) read_name(row, line);
    for (const auto& [column, name] : places_of_names_) check_name(column, name);
    return problems_.empty() && names_are_good();
  }

  void read_name(const RowReader& row, std::string_view line) {
    auto name = std::string(row.name());
    if (name.empty()) {
      wrong(row.column(),
            fmt::format("'{}' is no name of a column{}", row.shown_cell(), separator_hint(line)));
      return;
    }
    auto small = name;
    std::ranges::transform(small, small.begin(), lower);
    if (std::ranges::find(names_of_time, small) != names_of_time.end()) name = time_name;
    if (small == speed_name) name = speed_name;
    if (std::ranges::find(columns_, name) != columns_.end())
      wrong(row.column(), fmt::format("there are two columns '{}'", name));
    columns_.push_back(name);
    places_of_names_.emplace_back(row.column(), small);
    if (name != time_name && name != speed_name) path_.axes.push_back(name);
  }

  static std::string_view separator_hint(std::string_view line) {
    if (line.find(';') != std::string_view::npos)
      return "; it has semicolons, and commas must stand between the columns";
    if (line.find('\t') != std::string_view::npos)
      return "; it has tabs, and commas must stand between the columns";
    return "";
  }

  /// Whether a column is rather what is called t or speed than an axis.
  void check_name(std::size_t column, const std::string& name) {
    const auto is_like = [&](const auto& names) {
      return std::ranges::any_of(names, [&](auto one) { return begins_as(name, one); });
    };
    if (std::ranges::find(names_of_time, name) != names_of_time.end() || name == speed_name) return;
    // Beside u or e, v or f is a letter of an axis.
    const std::string before{static_cast<char>(name.front() - 1)};
    if (name.size() == 1 &&
        std::ranges::find(places_of_names_, before, &Place::second) != places_of_names_.end())
      return;
    if (is_like(like_time))
      wrong(column, fmt::format("'{}' is no axis; call a column of times t, in seconds", name));
    if (is_like(like_speed)) {
      wrong(column,
            fmt::format("'{}' is no axis; call a column of speeds speed, in units a second", name));
    }
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
    bool good = true;
    for (; row.next(); ++i) {
      if (i == columns_.size())
        return wrong(row.column(), fmt::format("there are more than {} cells", i));
      const auto& name = columns_[i];
      if (name == speed_name && !started_ && row.is_empty()) continue;
      const auto value = row.number();
      const auto objection =
          value ? objection_to(name, *value) : fmt::format("'{}' is no number", row.shown_cell());
      if (!objection.empty()) {
        wrong(row.column(), objection);
        good = false;
      } else if (name == time_name) {
        time = *value;
      } else if (name == speed_name) {
        next.feed = *value;
      } else {
        next.target[axis++] = *value;
      }
    }
    if (i < columns_.size())
      return wrong(0, fmt::format("the row has {} of {} cells", i, columns_.size()));
    return !good || add(std::move(next), time);
  }

  std::string objection_to(std::string_view name, double value) const {
    if (!started_) return "";
    if (name == time_name && value <= time_) return "t does not ascend";
    if (name == time_name && !std::isfinite(value - time_)) return "t leaps too far";
    if (name == speed_name && value <= 0) return "speed must be above 0";
    return "";
  }

  bool add(LineTo next, double time) {
    if (started_) {
      if (timed_) next.duration = time - time_;
      if (path_.elements.size() == most_elements) {
        wrong(0, fmt::format("the path is too long; {} elements at most", most_elements));
        return false;
      }
      if (!timed_ && std::ranges::equal(next.target, at_, are_equal)) return true;
      path_.elements.emplace_back(next);
    } else {
      path_.start = next.target;
    }
    started_ = true;
    at_ = next.target;
    time_ = time;
    return true;
  }

  using Place = std::pair<std::size_t, std::string>;

  ProblemList problems_;
  Path path_;
  std::vector<Place> places_of_names_;
  std::vector<std::string> columns_;
  std::size_t number_ = 0;
  bool timed_ = false;
  bool started_ = false;
  Point at_{};
  double time_ = 0;
};

}  // namespace

tl::expected<Path, TextProblems> read_csv(std::string_view text) { return CsvReader().read(text); }

}  // namespace tmcl::plan::path_file

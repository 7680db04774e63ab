#include "tmcl/plan/mint.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "motion/path/text_cursor.hpp"
#include "tmcl/spelling.hpp"

namespace tmcl::plan::mint {
namespace {

constexpr std::array<std::string_view, 7> keyword_names{"SCALE", "SPEED", "ACCEL", "DECEL",
                                                        "MOVEA", "MOVER", "GO"};

bool is_move(Keyword keyword) { return keyword == Keyword::movea || keyword == Keyword::mover; }

std::vector<unsigned> first_axes(std::size_t count) {
  std::vector<unsigned> axes(count);
  for (std::size_t i = 0; i < count; ++i) axes[i] = static_cast<unsigned>(i);
  return axes;
}

std::string in_capitals(std::string_view word) {
  std::string text(word);
  std::ranges::transform(text, text.begin(), upper);
  return text;
}

/// A part of a line; the error is why it cannot be read on.
class LineReader {
 public:
  LineReader(std::string_view line, std::size_t number) : cursor_(line), number_(number) {}

  /// Appends the statements of the line.
  tl::expected<void, TextProblem> read(Program& program) {
    while (true) {
      while (cursor_.take(':')) {
      }
      if (cursor_.at_end() || cursor_.peek() == '\'') return {};
      auto statement = read_statement();
      if (!statement) return tl::unexpected(statement.error());
      if (!*statement) return {};
      program.push_back(std::move(**statement));
      cursor_.skip_blanks();
      if (!cursor_.at_end() && cursor_.peek() != ':' && cursor_.peek() != '\'')
        return wrong(fmt::format("'{}' is too much here", shown(cursor_.word())));
    }
  }

 private:
  tl::unexpected<TextProblem> wrong(std::string message) const {
    return wrong_at(cursor_.column(), std::move(message));
  }
  static tl::unexpected<TextProblem> wrong_at(std::size_t column, std::string message) {
    return tl::unexpected(TextProblem{0, column, std::move(message)});
  }

  /// Nothing if it is a remark.
  tl::expected<std::optional<Statement>, TextProblem> read_statement() {
    const auto column = cursor_.column();
    const auto name = in_capitals(
        cursor_.take_while([](char c) { return is_letter(c) || is_digit(c) || c == '_'; }));
    if (name == "REM") return std::nullopt;
    const auto* found = std::ranges::find(keyword_names, name);
    if (found == keyword_names.end()) return wrong_at(column, unknown(name));
    Statement statement;
    statement.keyword = static_cast<Keyword>(found - keyword_names.begin());
    statement.line = number_;
    statement.column = column;
    auto axes = read_axes();
    if (!axes) return tl::unexpected(axes.error());
    if (statement.keyword == Keyword::go) {
      statement.axes = std::move(*axes);
      return statement;
    }
    auto values = read_values(statement.keyword, std::move(*axes));
    if (!values) return tl::unexpected(values.error());
    statement.values = std::move(*values);
    return statement;
  }

  std::string unknown(const std::string& name) const {
    if (name.empty())
      return fmt::format("a keyword must stand here, not '{}'", shown(cursor_.word()));
    return fmt::format("'{}' is none of {}.{}", shown(name), fmt::join(keyword_names, ", "),
                       did_you_mean(name, keyword_names));
  }

  tl::expected<std::vector<unsigned>, TextProblem> read_axes() {
    std::vector<unsigned> axes;
    const bool one = cursor_.take('.');
    const char close = one ? '\0' : cursor_.take('[') ? ']' : cursor_.take('(') ? ')' : '\0';
    if (!one && close == '\0') return axes;
    do {
      cursor_.skip_blanks();
      const auto column = cursor_.column();
      const auto axis = read_axis();
      if (!axis) return tl::unexpected(axis.error());
      if (std::ranges::find(axes, *axis) != axes.end())
        return wrong_at(column, fmt::format("axis {} is named twice", *axis));
      axes.push_back(*axis);
    } while (!one && cursor_.take(','));
    if (!one && !cursor_.take(close)) return wrong(fmt::format("'{}' is missing", close));
    return axes;
  }

  tl::expected<unsigned, TextProblem> read_axis() {
    const auto column = cursor_.column();
    const auto digits = cursor_.take_while(is_digit);
    unsigned axis = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), axis);
    if (digits.empty()) return wrong("the number of an axis is missing");
    if (error != std::errc{} || axis >= most_axes) {
      return wrong_at(column, fmt::format("there is no axis {}; they are 0 to {}", shown(digits),
                                          most_axes - 1));
    }
    return axis;
  }

  tl::expected<std::vector<AxisValue>, TextProblem> read_values(Keyword keyword,
                                                                std::vector<unsigned> axes) {
    if (!cursor_.take('=')) return wrong(fmt::format("'=' is missing after {}", name_of(keyword)));
    std::vector<double> values;
    std::size_t column = 0;
    do {
      cursor_.skip_blanks();
      column = cursor_.column();
      const auto value = read_value(keyword);
      if (!value) return tl::unexpected(value.error());
      values.push_back(*value);
      if (values.size() > most_axes)
        return wrong_at(column, fmt::format("there are {} axes at most", most_axes));
    } while (cursor_.take(','));
    return distribute(keyword, std::move(axes), std::move(values), column);
  }

  tl::expected<double, TextProblem> read_value(Keyword keyword) {
    const auto column = cursor_.column();
    if (cursor_.at_end() || cursor_.peek() == '\'') return wrong("a number is missing");
    const auto word = cursor_.word();
    const auto value = cursor_.take_number();
    if (!value) return wrong_at(column, fmt::format("'{}' is no number", shown(word)));
    if (!is_move(keyword) && *value <= 0)
      return wrong_at(column, fmt::format("{} must be above 0", name_of(keyword)));
    return *value;
  }

  /// A semicolon after the last value: it holds for all axes that are left.
  tl::expected<std::vector<AxisValue>, TextProblem> distribute(Keyword keyword,
                                                               std::vector<unsigned> axes,
                                                               std::vector<double> values,
                                                               std::size_t column) {
    const bool same_for_the_rest = cursor_.take(';');
    if (axes.empty()) {
      if (same_for_the_rest && is_move(keyword))
        return wrong_at(column, fmt::format("which axes? ';' needs a list, as in {}[0,1] = 10;",
                                            name_of(keyword)));
      axes = first_axes(same_for_the_rest ? most_axes : values.size());
    }
    if (same_for_the_rest) values.resize(std::max(values.size(), axes.size()), values.back());
    if (values.size() != axes.size()) {
      return wrong_at(
          column,
          fmt::format("{} value{} for {} {}", values.size(), values.size() == 1 ? "" : "s",
                      axes.size(),
                      axes.size() == 1 ? "axis" : "axes; ';' after the last value repeats it"));
    }
    std::vector<AxisValue> pairs;
    for (std::size_t i = 0; i < axes.size(); ++i) pairs.push_back({axes[i], values[i]});
    return pairs;
  }

  TextCursor cursor_;
  std::size_t number_;
};

/// An axis while the program runs.
struct Axis {
  struct Loaded {
    Keyword keyword;
    double value;
    std::size_t line;
  };
  double counts = 0;
  double scale = 1;
  std::optional<double> speed{};
  std::optional<double> accel{};
  std::optional<double> decel{};
  std::optional<Loaded> loaded{};
  double ready = 0;
};

class Runner {
 public:
  explicit Runner(const Positions& start_counts) {
    for (std::size_t i = 0; i < most_axes; ++i) axes_[i].counts = start_counts[i];
  }

  void run(const Statement& statement) {
    if (statement.keyword == Keyword::go) return go(statement);
    for (const auto& [axis, value] : statement.values) assign(statement, axis, value);
  }

  tl::expected<DryRun, TextProblems> finish() {
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    for (unsigned i = 0; i < most_axes; ++i) {
      const auto& axis = axes_[i];
      result_.end[i] = axis.counts / axis.scale;
      result_.duration = std::max(result_.duration, axis.ready);
      if (axis.loaded) {
        result_.warnings.push_back(
            {axis.loaded->line, 0, fmt::format("no GO starts the move of axis {}", i)});
      }
    }
    return std::move(result_);
  }

 private:
  void assign(const Statement& statement, unsigned number, double value) {
    auto& axis = axes_[number];
    switch (statement.keyword) {
      case Keyword::scale: axis.scale = value; break;
      case Keyword::speed: axis.speed = value; break;
      case Keyword::accel: axis.accel = value; break;
      case Keyword::decel: axis.decel = value; break;
      case Keyword::movea:
      case Keyword::mover: load(statement, number, value); break;
      case Keyword::go: break;
    }
  }

  void load(const Statement& statement, unsigned number, double value) {
    auto& loaded = axes_[number].loaded;
    if (loaded) {
      return object(statement,
                    fmt::format("axis {} has a move loaded already, on line {}; GO starts it",
                                number, loaded->line));
    }
    loaded = {statement.keyword, value, statement.line};
  }

  void go(const Statement& statement) {
    auto numbers = statement.axes;
    if (numbers.empty()) {
      for (unsigned i = 0; i < most_axes; ++i) {
        if (axes_[i].loaded) numbers.push_back(i);
      }
    }
    if (numbers.empty()) return object(statement, "no axis has a move loaded");
    Group group;
    group.line = statement.line;
    for (const auto number : numbers) {
      if (auto move = start(statement, number)) group.moves.push_back(std::move(*move));
    }
    time(group);
    result_.groups.push_back(std::move(group));
  }

  std::optional<Move> start(const Statement& statement, unsigned number) {
    auto& axis = axes_[number];
    if (!axis.loaded) {
      object(statement, fmt::format("axis {} has no move loaded", number));
      return std::nullopt;
    }
    const auto loaded = *std::exchange(axis.loaded, std::nullopt);
    Move move{number, loaded.line, axis.scale, axis.counts / axis.scale, loaded.value, {}};
    if (loaded.keyword == Keyword::mover) move.end += move.start;
    axis.counts = move.end * axis.scale;
    if (!std::isfinite(axis.counts)) {
      object(statement, fmt::format("axis {} would go beyond all numbers", number));
      return std::nullopt;
    }
    if (move.end == move.start) return move;
    for (const auto* missing : {axis.speed ? nullptr : "SPEED", axis.accel ? nullptr : "ACCEL"}) {
      if (missing == nullptr) continue;
      object(statement, fmt::format("axis {} has no {}", number, missing));
      return std::nullopt;
    }
    const auto profile = profile_of(axis, std::abs(move.end - move.start));
    if (!profile) {
      object(statement, fmt::format("axis {}: {}", number, describe(profile.error())));
      return std::nullopt;
    }
    move.profile = *profile;
    return move;
  }

  static tl::expected<Profile, SolveError> profile_of(const Axis& axis, double distance) {
    Given given;
    given[Quantity::distance] = distance;
    given[Quantity::acceleration] = axis.accel;
    given[Quantity::deceleration] = axis.decel ? axis.decel : axis.accel;
    auto triangle = given;
    triangle[Quantity::slew_time] = 0;
    auto peak = solve(triangle);
    if (peak && peak->speed <= *axis.speed) return peak;
    given[Quantity::speed] = axis.speed;
    return solve(given);
  }

  void time(Group& group) {
    for (const auto& move : group.moves) {
      group.start_time = std::max(group.start_time, axes_[move.axis].ready);
      group.duration = std::max(group.duration, move.duration());
    }
    for (const auto& move : group.moves)
      axes_[move.axis].ready = group.start_time + move.duration();
  }

  void object(const Statement& statement, std::string message) {
    problems_.add(statement.line, statement.column, std::move(message));
  }

  std::array<Axis, most_axes> axes_{};
  DryRun result_;
  ProblemList problems_;
};

}  // namespace

std::string_view name_of(Keyword keyword) {
  return keyword_names[static_cast<std::size_t>(keyword)];
}

tl::expected<Program, TextProblems> read(std::string_view text) {
  Program program;
  ProblemList problems;
  for_each_line(text, problems, [&](std::string_view line, std::size_t number) {
    const auto read = LineReader(line, number).read(program);
    if (!read) problems.add(number, read.error().column, read.error().message);
    if (program.size() <= most_statements) return true;
    problems.add(number, 0,
                 fmt::format("the program is too long; {} statements at most", most_statements));
    return false;
  });
  if (!problems.empty()) return tl::unexpected(problems.take());
  return program;
}

tl::expected<DryRun, TextProblems> dry_run(const Program& program, const Positions& start_counts) {
  Runner runner(start_counts);
  for (const auto& statement : program) runner.run(statement);
  return runner.finish();
}

}  // namespace tmcl::plan::mint

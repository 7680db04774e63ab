/// The text of a program: its files one within the other, as lines without comments.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program/expression.hpp"
#include "tmcl/assembler.hpp"

namespace tmcl::program {

/// Problems, as they are found; there may be many.
class Problems {
 public:
  bool empty() const { return all_.empty(); }
  bool full() const { return all_.size() >= most_problems; }
  /// `line`: counted through all files; says where the problem stands among the others.
  void add(std::size_t line, TextProblem problem) {
    if (!full()) all_.emplace_back(line, std::move(problem));
  }
  TextProblems in_order() const;

 private:
  std::vector<std::pair<std::size_t, TextProblem>> all_;
};

struct Line {
  std::size_t file = 0;
  std::size_t number = 0;  ///< From 1.
  std::string_view text;   ///< As it is written.
  std::string_view code;   ///< The same with blanks for comments and for what is done already.
};

/// The files, and their lines in the order in which they are meant.
class Source {
 public:
  Source(const std::string& path, const ReadFile& read, Problems& problems);
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;

  const std::vector<std::string>& files() const { return files_; }
  const std::vector<Line>& lines() const { return lines_; }
  void report(std::size_t line, const TextProblem& problem);
  /// Whether the names of axis parameters are constants, as the TMCL-IDE's TMCLParam.tmc makes
  /// them.
  bool names_parameters() const { return names_parameters_; }

 private:
  void take_file(const std::string& path, std::string text);
  void take_lines(std::string_view text, std::string_view code, std::size_t open_comment);
  bool take_line(Line line);
  void include(Cursor cursor);
  tl::expected<std::string, std::string> path_of(const std::string& name) const;
  void report_file(std::string message);
  void report_last(const TextProblem& problem) { report(lines_.size() - 1, problem); }

  const ReadFile& read_;
  Problems& problems_;
  std::vector<std::string> files_;
  std::deque<std::string> texts_;  ///< What the lines are parts of.
  std::vector<Line> lines_;
  std::vector<std::size_t> open_files_;  ///< Each includes the next.
  std::size_t bytes_ = 0;
  bool names_parameters_ = false;
  bool exhausted_ = false;  ///< A bound is reached; no more is read.
};

}  // namespace tmcl::program

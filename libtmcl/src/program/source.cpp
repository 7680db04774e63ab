#include "program/source.hpp"

#include <algorithm>
#include <filesystem>

#include "core/text.hpp"

namespace tmcl::program {
namespace {

constexpr auto none = std::string_view::npos;

// The TMCL-IDE has this file, and examples of manuals begin with it.
constexpr std::string_view parameter_file = "TMCLParam.tmc";

/// The text with comments blanked, and where one begins that does not end.
struct Blanked {
  std::string code;
  std::size_t open_comment = none;
};

/// From `begin` up to before `end`; line ends stay.
void blank(std::string& text, std::size_t begin, std::size_t end) {
  for (auto i = begin; i < std::min(end, text.size()); ++i) {
    if (text[i] != '\n') text[i] = ' ';
  }
}

Blanked without_comments(std::string text) {
  std::size_t open_comment = none;
  bool in_quotes = false;
  for (std::size_t i = 0; i < text.size();) {
    const auto two = std::string_view(text).substr(i, 2);
    auto end = i + 1;
    if (text[i] == '"' || text[i] == '\n') {
      in_quotes = text[i] == '"' && !in_quotes;
    } else if (!in_quotes && two == "//") {
      end = std::min(text.find('\n', i), text.size());
      blank(text, i, end);
    } else if (!in_quotes && two == "/*") {
      const auto close = text.find("*/", i + 2);
      if (close == none) open_comment = i;
      end = close == none ? text.size() : close + 2;
      blank(text, i, end);
    }
    i = end;
  }
  return {std::move(text), open_comment};
}

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  return text.starts_with(byte_order_mark) ? text.substr(byte_order_mark.size()) : text;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string normal(const std::string& path) {
  return std::filesystem::path(path).lexically_normal().string();
}

/// The name of an included file, of what follows #include; empty if there is none.
std::string_view file_name(std::string_view text) {
  text = trimmed(text);
  if (!text.starts_with('"')) return text;
  text.remove_prefix(1);
  if (!text.ends_with('"')) return {};
  text.remove_suffix(1);
  return text;
}

}  // namespace

TextProblems Problems::in_order() const {
  auto sorted = all_;
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) {
    return std::pair(a.first, a.second.column) < std::pair(b.first, b.second.column);
  });
  TextProblems problems;
  for (auto& [line, problem] : sorted) problems.push_back(std::move(problem));
  return problems;
}

Source::Source(const std::string& path, const ReadFile& read, Problems& problems)
    : read_(read), problems_(problems) {
  auto text = read_(path);
  if (text) {
    take_file(path, std::move(*text));
  } else {
    problems_.add(0, {0, 0, "cannot be read: " + text.error(), {}, path});
  }
}

void Source::report(std::size_t line, const TextProblem& problem) {
  const auto& at = lines_[line];
  problems_.add(line, {at.number, problem.column, problem.message, problem.word, files_[at.file]});
}

/// About the file that is being read.
void Source::report_file(std::string message) {
  problems_.add(lines_.size(), {0, 0, std::move(message), {}, files_[open_files_.back()]});
}

void Source::take_file(const std::string& path, std::string text) {
  open_files_.push_back(files_.size());
  files_.push_back(path);
  bytes_ += text.size();
  if (bytes_ > most_source_bytes) {
    exhausted_ = true;
    report_file("a program's text has at most " + std::to_string(most_source_bytes) + " bytes");
  } else {
    const std::string_view kept = texts_.emplace_back(without_mark(text));
    auto blanked = without_comments(std::string(kept));
    take_lines(kept, texts_.emplace_back(std::move(blanked.code)), blanked.open_comment);
  }
  open_files_.pop_back();
}

void Source::take_lines(std::string_view text, std::string_view code, std::size_t open_comment) {
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size() && !exhausted_;) {
    const auto end = std::min(text.find('\n', begin), text.size());
    const auto size = end - begin - (end > begin && text[end - 1] == '\r' ? 1 : 0);
    if (!take_line(
            {open_files_.back(), ++number, text.substr(begin, size), code.substr(begin, size)}))
      return;
    if (open_comment >= begin && open_comment < end)
      report_last(within_line(open_comment - begin, "/*", "this comment does not end"));
    begin = end + 1;
  }
}

/// False if the rest of the file had better not be read.
bool Source::take_line(Line line) {
  if (lines_.size() == most_source_lines) {
    exhausted_ = true;
    report_file("a program's text has at most " + std::to_string(most_source_lines) + " lines");
    return false;
  }
  lines_.push_back(line);
  if (const auto nul = line.text.find('\0'); nul != none) {
    lines_.back().code = {};
    report_last(within_line(nul, {}, "here is a byte 0: this is no text"));
    return false;
  }
  if (line.text.size() > longest_line) {
    lines_.back().code = {};
    report_last(within_line(longest_line, {},
                            "a line has at most " + std::to_string(longest_line) + " bytes"));
    return true;
  }
  Cursor cursor(line.code);
  cursor.skip_blanks();
  if (cursor.peek() == '#') {
    lines_.back().code = {};
    include(cursor);
  }
  return true;
}

void Source::include(Cursor cursor) {
  const auto line = lines_.size() - 1;
  const auto hash = cursor.at();
  cursor.skip();
  const auto word = cursor.take_while(is_in_name);
  if (!text::equal_ignoring_case(word, "include")) {
    const auto directive = "#" + printable(word);
    return report(line, within_line(hash, directive,
                                    "'" + directive + "' is no directive; there is only #include"));
  }
  cursor.skip_blanks();
  const auto where = cursor.at();
  const std::string name(file_name(cursor.take_rest()));
  const auto path = path_of(name);
  if (!path) return report(line, within_line(where, printable(name), path.error()));
  auto text = read_(*path);
  if (text) return take_file(*path, std::move(*text));
  if (text::equal_ignoring_case(std::filesystem::path(name).filename().string(), parameter_file)) {
    names_parameters_ = true;
    return;
  }
  report(line, within_line(where, printable(name),
                           "'" + printable(name) + "' cannot be read: " + text.error()));
}

/// Where a file is that the current one includes, or why it cannot be included.
tl::expected<std::string, std::string> Source::path_of(const std::string& name) const {
  if (name.empty()) return tl::unexpected(std::string("the name of a file is missing"));
  const auto beside = std::filesystem::path(files_[open_files_.back()]).parent_path();
  const auto path = (beside / name).lexically_normal().string();
  for (const auto file : open_files_) {
    if (normal(files_[file]) == path)
      return tl::unexpected("'" + printable(name) + "' includes itself");
  }
  if (open_files_.size() > deepest_include)
    return tl::unexpected("files are included more than " + std::to_string(deepest_include) +
                          " deep");
  if (files_.size() >= most_files)
    return tl::unexpected("more than " + std::to_string(most_files) + " files");
  return path;
}

}  // namespace tmcl::program

#include "path/path_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "input_file.hpp"
#include "plot/plane.hpp"

namespace tmclctl::path {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;
namespace path_file = tmcl::plan::path_file;

constexpr std::size_t most_bytes = std::size_t{64} << 20;
// So many points make a curve that looks smooth.
constexpr int curve_points = 2000;

bool has_ending(std::string name, std::string_view ending) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.ends_with(ending);
}

// A table begins with the names of its columns, G-code with a word, a comment or a line of %.
bool looks_like_gcode(std::string_view text) {
  while (!text.empty()) {
    const auto line = text.substr(0, text.find('\n'));
    const auto first = line.find_first_not_of(" \t\r");
    if (first != std::string_view::npos && line[first] != '#')
      return line.find(',') == std::string_view::npos;
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return false;
}

bool is_gcode(const std::string& file, std::string_view text) {
  constexpr std::array<std::string_view, 5> endings{".ngc", ".nc", ".gcode", ".gco", ".tap"};
  if (has_ending(file, ".csv")) return false;
  const bool named = std::ranges::any_of(endings, [&](auto end) { return has_ending(file, end); });
  return named || looks_like_gcode(text);
}

}  // namespace

Failure failure_from(const std::string& file, const plan::TextProblems& problems, Output& output) {
  const bool all = problems.size() < plan::most_text_problems;
  auto failure = usage_failure(
      "bad_program", fmt::format("{}{} problem{} in {}", all ? "" : "at least ", problems.size(),
                                 problems.size() == 1 ? "" : "s", file));
  json::array list;
  for (const auto& problem : problems) {
    if (!output.json) output.err << describe(problem, file) << '\n';
    list.push_back(json::object{
        {"line", problem.line}, {"column", problem.column}, {"message", problem.message}});
  }
  failure.details["problems"] = std::move(list);
  return failure;
}

Attempt<std::string> text_of(const std::string& file, std::size_t most) {
  auto text = read_file(file, most + 1);
  if (!text) {
    return tl::unexpected(
        usage_failure("cannot_read", fmt::format("cannot read {}: {}", file, text.error())));
  }
  if (text->size() > most) {
    return tl::unexpected(
        usage_failure("bad_program", fmt::format("{} is too long; {} bytes at most", file, most)));
  }
  return std::move(*text);
}

Attempt<Source> read_source(const std::string& file, double tolerance, Output& output) {
  const auto text = text_of(file, most_bytes);
  if (!text) return tl::unexpected(text.error());
  const bool gcode = is_gcode(file, *text);
  auto path = gcode ? path_file::read_gcode(*text) : path_file::read_csv(*text);
  if (!path) return tl::unexpected(failure_from(file, path.error(), output));
  auto flat = path_file::flatten(*path, tolerance * chords_part);
  if (!flat) return tl::unexpected(usage_failure("bad_path", file + ": " + flat.error()));
  if (flat->elements.empty())
    return tl::unexpected(usage_failure("bad_path", file + " moves nothing"));
  return Source{file, gcode, std::move(*flat)};
}

Attempt<plan::Course> course_of(const Source& source, plan::PathLimits limits, double tolerance,
                                double feed) {
  limits.axes = source.path.axes.size();
  limits.corner_tolerance = tolerance * corners_part;
  return plan::Course::of(source.path, limits, feed).map_error([&](const std::string& why) {
    return usage_failure("bad_path", source.file + ": " + why);
  });
}

std::string to_svg(const Source& source, const plan::Course& course) {
  const std::size_t second = std::min<std::size_t>(1, course.axes() - 1);
  plot::Plane plane{
      fmt::format("{}: {:.6g} units in {:.6g} s", source.file, course.length(), course.duration()),
      source.path.axes[0],
      source.path.axes[second],
      {},
      {}};
  plot::Picture picture{"", "s", {}, {}};
  for (std::size_t axis = 0; axis < course.axes(); ++axis)
    picture.curves.push_back({"position", source.path.axes[axis], {}, {}});
  for (int i = 0; i <= curve_points; ++i) {
    const double time = course.duration() * i / curve_points;
    const auto position = course.at(time).position;
    plane.planned.x.push_back(position[0]);
    plane.planned.y.push_back(position[second]);
    for (std::size_t axis = 0; axis < course.axes(); ++axis) {
      picture.curves[axis].times.push_back(time);
      picture.curves[axis].values.push_back(position[axis]);
    }
  }
  return plot::to_svg(plane, picture);
}

}  // namespace tmclctl::path

#include "path/path_source.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "input_file.hpp"
#include "plot/plane.hpp"

namespace tmclctl::path {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;

constexpr std::size_t most_bytes = std::size_t{64} << 20;
// So many points make a curve that looks smooth.
constexpr int curve_points = 2000;

Failure failure_of(const std::string& file, const plan::PathObjection& objection, Output& output) {
  if (!objection.problems.empty()) return path::failure_from(file, objection.problems, output);
  auto failure = path::failure_from(objection);
  failure.message = file + ": " + failure.message;
  return failure;
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

Failure failure_from(const plan::PathObjection& objection) {
  auto failure = usage_failure(objection.name, objection.message);
  failure.exit = exit_for_objection(objection.name);
  return failure;
}

Attempt<Source> read_source(const std::string& file, double tolerance, Output& output) {
  auto text = text_of(file, most_bytes);
  if (!text) return tl::unexpected(text.error());
  auto source = plan::read_path(*text, plan::format_of(file, *text), tolerance);
  if (!source) return tl::unexpected(failure_of(file, source.error(), output));
  return Source{std::move(*source), file, std::move(*text)};
}

Attempt<void> begin_where_axes_stand(Source& source, const std::vector<plan::PathAxis>& axes,
                                     const plan::PathRequest& request, Output& output) {
  auto begun = plan::from_where_axes_stand(source, source.text, axes, request);
  if (!begun) return tl::unexpected(failure_of(source.file, begun.error(), output));
  static_cast<plan::PathSource&>(source) = std::move(*begun);
  return {};
}

Attempt<plan::Course> course_of(const Source& source, const plan::PathLimits& limits,
                                const plan::PathRequest& request) {
  return plan::course_of(source, limits, request).map_error([&](const auto& objection) {
    auto failure = failure_from(objection);
    failure.message = source.file + ": " + failure.message;
    return failure;
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

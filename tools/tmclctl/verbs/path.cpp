// path check.
#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "output_file.hpp"
#include "path/path_report.hpp"
#include "path/path_source.hpp"
#include "print.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace path {
namespace {

namespace json = boost::json;

constexpr std::size_t most_corners = 5;

}  // namespace

json::object to_json(const Source& source, const tmcl::plan::Course& course) {
  json::array axes;
  for (std::size_t axis = 0; axis < course.axes(); ++axis) {
    axes.push_back(json::object{{"axis", source.path.axes[axis]},
                                {"least", course.least()[axis]},
                                {"greatest", course.greatest()[axis]},
                                {"top_speed", course.top_speed(axis)}});
  }
  json::array corners;
  for (const auto& corner : course.slowest_corners(most_corners)) {
    json::array position(corner.position.begin(),
                         corner.position.begin() + static_cast<std::ptrdiff_t>(course.axes()));
    corners.push_back(json::object{{"line", corner.line},
                                   {"time_s", corner.time},
                                   {"speed", corner.speed},
                                   {"position", std::move(position)}});
  }
  return {{"file", source.file},
          {"length", course.length()},
          {"duration_s", course.duration()},
          {"legs", course.legs()},
          {"axes", std::move(axes)},
          {"slowest_corners", std::move(corners)}};
}

void print(const Source& source, const tmcl::plan::Course& course, Output& output) {
  output.out << fmt::format("{}: {:.6g} units in {:.4g} s, {} legs\n\n", source.file,
                            course.length(), course.duration(), course.legs());
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  Table axes({"AXIS", "FROM", "TO", "TOP SPEED"});
  for (std::size_t axis = 0; axis < course.axes(); ++axis) {
    axes.add({source.path.axes[axis], number(course.least()[axis]), number(course.greatest()[axis]),
              number(course.top_speed(axis))});
  }
  axes.print(output.out);
  const auto slowest = course.slowest_corners(most_corners);
  if (slowest.empty()) return;
  output.out << '\n';
  Table corners({"SLOWEST CORNER", "TIME", "SPEED"});
  for (const auto& corner : slowest) {
    corners.add({fmt::format("end of line {}", corner.line), fmt::format("{:.4g} s", corner.time),
                 number(corner.speed)});
  }
  corners.print(output.out);
}

Attempt<void> draw(const std::string& svg_path, const Source& source,
                   const tmcl::plan::Course& course) {
  if (svg_path.empty()) return {};
  OutputFile svg;
  return svg.open(svg_path).and_then([&] { return svg.write(to_svg(source, course)); });
}

}  // namespace path

VerbResult run(const verb::CheckPath& verb, Output& output) {
  const auto source = path::read_source(verb.file, verb.tolerance, output);
  if (!source) return tl::unexpected(source.error());
  tmcl::plan::PathLimits limits;
  limits.axis.fill({verb.velocity, verb.acceleration});
  tmcl::plan::PathRequest request;
  request.tolerance = verb.tolerance;
  request.feed = verb.feed;
  const auto course = path::course_of(*source, limits, request);
  if (!course) return tl::unexpected(course.error());
  if (const auto drawn = path::draw(verb.svg, *source, *course); !drawn)
    return tl::unexpected(drawn.error());
  if (output.json) {
    print_json(path::to_json(*source, *course), output);
  } else {
    path::print(*source, *course, output);
  }
  return ExitCode::done;
}

}  // namespace tmclctl

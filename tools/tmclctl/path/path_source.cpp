#include "path/path_source.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <boost/json/array.hpp>

#include "input_file.hpp"
#include "json_read.hpp"
#include "output_file.hpp"
#include "plot/plane.hpp"
#include "print.hpp"
#include "text_problems.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl::path {
namespace {

namespace json = boost::json;
namespace plan = tmcl::plan;

double number(const json::value& value) { return value.to_number<double>(); }

std::string figure(const json::object& row, const char* key, int digits = 6) {
  return tmcl::plain_number(number_at(row, key).value_or(0), digits);
}

std::string to_svg(const std::string& file, const json::object& course, const json::object& curve) {
  const auto& axes = array_at(course, "axes");
  const std::size_t second = std::min<std::size_t>(1, axes.size() - 1);
  const auto name = [&](std::size_t axis) { return text_at(axes[axis].as_object(), "axis"); };
  plot::Plane plane{fmt::format("{}: {} units in {} s", file, figure(course, "length"),
                                figure(course, "duration_s")),
                    name(0),
                    name(second),
                    {},
                    {}};
  plot::Picture picture{"", "s", {}, {}};
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    picture.curves.push_back({"position", name(axis), {}, {}});
  const auto& times = array_at(curve, "times_s");
  const auto& positions = array_at(curve, "positions");
  for (std::size_t i = 0; i < std::min(times.size(), positions.size()); ++i) {
    const auto& position = positions[i].as_array();
    plane.planned.x.push_back(number(position.at(0)));
    plane.planned.y.push_back(number(position.at(second)));
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      picture.curves[axis].times.push_back(number(times[i]));
      picture.curves[axis].values.push_back(number(position.at(axis)));
    }
  }
  return plot::to_svg(plane, picture);
}

}  // namespace

Result<std::string> text_of(const std::string& file, std::size_t most) {
  auto text = read_file(file, most + 1);
  if (!text) {
    return tl::unexpected(
        usage_error("cannot_read", fmt::format("cannot read {}: {}", file, text.error())));
  }
  if (text->size() > most) {
    return tl::unexpected(
        usage_error("bad_program", fmt::format("{} is too long; {} bytes at most", file, most)));
  }
  return std::move(*text);
}

Error explained(Error failure, const std::string& file, Output& output) {
  tmcl::TextProblems problems;
  for (const auto& value : array_at(failure.subject, "problems")) {
    const auto& row = value.as_object();
    problems.push_back({integer_at<std::size_t>(row, "line"),
                        integer_at<std::size_t>(row, "column"), text_at(row, "message")});
  }
  if (!problems.empty()) return error_from(file, problems, tmcl::plan::most_text_problems, output);
  const auto axis = text_at(failure.subject, "file_axis");
  if (!axis.empty()) failure.hint = fmt::format("--axis {}=NAME", axis);
  if (failure.name == "bad_path") failure.message = file + ": " + failure.message;
  if (failure.name == "unknown_unit" && failure.hint.empty()) {
    failure.hint =
        "--per-turn says how many units of the file a turn of the motor is; tmcld.toml can, too";
  }
  return failure;
}

void warn(const json::object& report, Output& output) {
  tmclctl::warn(texts_at(report, "remarks"), output);
}

void print(const std::string& file, const json::object& course, Output& output) {
  const auto legs = integer_at<std::size_t>(course, "legs");
  output.out << fmt::format("{}: {} units in {} s, {} {}\n\n", file, figure(course, "length"),
                            figure(course, "duration_s", 4), legs, legs == 1 ? "leg" : "legs");
  Table axes({"AXIS", "FROM", "TO", "TOP SPEED"});
  for (const auto& value : array_at(course, "axes")) {
    const auto& row = value.as_object();
    axes.add({text_at(row, "axis"), figure(row, "least"), figure(row, "greatest"),
              figure(row, "top_speed")});
  }
  axes.print(output.out);
  const auto& slowest = array_at(course, "slowest_corners");
  if (slowest.empty()) return;
  output.out << '\n';
  Table corners({"SLOWEST CORNER", "TIME", "SPEED"});
  for (const auto& value : slowest) {
    const auto& row = value.as_object();
    corners.add({fmt::format("end of line {}", integer_at<std::size_t>(row, "line")),
                 figure(row, "time_s", 4) + " s", figure(row, "speed")});
  }
  corners.print(output.out);
}

Result<void> draw(const std::string& svg_path, const std::string& file, const json::object& course,
                  const json::object& curve) {
  OutputFile svg;
  return svg.open(svg_path).and_then([&] { return svg.write(to_svg(file, course, curve)); });
}

}  // namespace tmclctl::path

#include "path/path_source.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "command_line/input_file.hpp"
#include "command_line/text_problems.hpp"
#include "output/print.hpp"
#include "plot/plane.hpp"
#include "plot/text_plot.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl::path {
namespace {

namespace api = tmcl::api;

using api::path::Course;
using api::path::Curve;

std::string figure(double number, int digits = 6) { return tmcl::plain_number(number, digits); }

plot::Curve curve_of(plot::Quantity quantity, const plot::Curve& position,
                     const std::vector<double>& breaks) {
  if (quantity == plot::Quantity::position) return position;
  const auto& axis = position.unit;
  auto velocity = plot::derivative(position, "velocity", axis + "/s", breaks);
  if (quantity == plot::Quantity::velocity) return velocity;
  auto acceleration = plot::derivative(velocity, "acceleration", axis + "/s^2", breaks);
  if (quantity == plot::Quantity::acceleration) return acceleration;
  return plot::derivative(acceleration, "jerk", axis + "/s^3", breaks);
}

/// The slowest corners, each by its line.
std::vector<plot::Mark> marks_of(const Course& course) {
  std::vector<plot::Mark> marks;
  for (const auto& corner : course.slowest_corners)
    marks.push_back({corner.time_s, fmt::format("line {}", corner.line)});
  std::ranges::sort(marks, {}, &plot::Mark::time);
  return marks;
}

plot::Picture picture_of(const Course& course, const Curve& curve, const Drawn& drawn) {
  plot::Picture picture{"", "s", {}, drawn.phases.empty() ? marks_of(course) : drawn.phases};
  std::vector<double> breaks;
  for (const auto& phase : drawn.phases) breaks.push_back(phase.time);
  const auto points = std::min(curve.times_s.size(), curve.positions.size());
  for (std::size_t axis = 0; axis < course.axes.size(); ++axis) {
    plot::Curve position{"position", course.axes[axis].axis, curve.times_s, {}};
    position.times.resize(points);
    for (std::size_t i = 0; i < points; ++i) position.values.push_back(curve.positions[i].at(axis));
    for (const auto quantity : drawn.shown)
      picture.curves.push_back(curve_of(quantity, position, breaks));
  }
  return picture;
}

std::string title(const std::string& file, const Course& course) {
  return fmt::format("{}: {} units in {} s", file, figure(course.length),
                     figure(course.duration_s));
}

void print_corners(const Course& course, Output& output) {
  if (course.slowest_corners.empty()) return;
  output.out << '\n';
  Table corners({"SLOWEST CORNER", "TIME", "SPEED"});
  for (const auto& corner : course.slowest_corners)
    corners.add({fmt::format("end of line {}", corner.line), figure(corner.time_s, 4) + " s",
                 figure(corner.speed)});
  corners.print(output);
}

/// What is done where it stands.
void print_halts(const Course& course, Output& output) {
  if (!course.words.empty()) {
    output.out << '\n';
    Table words({"WORD", "SWITCHES", "TIMES", "FIRST AT"});
    for (const auto& word : course.words)
      words.add({fmt::format("M{}", word.number), word.switches, std::to_string(word.times),
                 fmt::format("line {}", word.line)});
    words.print(output);
  }
  if (course.waits > 0)
    output.out << fmt::format("\nwaits {} at M0 until 'tmclctl path resume'\n",
                              course.waits == 1 ? "once" : fmt::format("{} times", course.waits));
}

constexpr double enlarged = 10;

/// Of a Passage or a MotorPassage. `second`: the axis that is drawn upwards.
template <class Passage>
void add_seen(const Passage& passage, const char* whose, std::size_t second, plot::Plane& plane) {
  if (!passage.seen) return;
  const auto on_path = passage.on_path.value_or(Curve{}).positions;
  const auto away = [&](std::size_t i, std::size_t axis) {
    return std::lerp(on_path[i].at(axis), passage.seen->positions[i].at(axis), enlarged);
  };
  for (std::size_t i = 0; i < passage.seen->positions.size(); ++i) {
    plane.seen.x.push_back(passage.seen->positions[i].at(0));
    plane.seen.y.push_back(passage.seen->positions[i].at(second));
    if (i >= on_path.size()) continue;
    plane.enlarged.x.push_back(away(i, 0));
    plane.enlarged.y.push_back(away(i, second));
  }
  plane.enlarged_name = "ten times off";
  plane.marked = {passage.off_path_at.at(0), passage.off_path_at.at(second),
                  fmt::format("{}{} off the path, at {} s, {}", whose, figure(passage.off_path, 3),
                              figure(passage.off_path_at_s, 4),
                              tolerance_verdict(passage.tolerance_exceeded_by))};
}

/// By the motors where there are encoders.
void add(const api::path::Passage& passage, std::size_t second, plot::Plane& plane) {
  if (passage.motors && passage.motors->seen) {
    add_seen(*passage.motors, "motors ", second, plane);
  } else {
    add_seen(passage, "", second, plane);
  }
}

/// Where the plan itself leaves what the file draws: chords of arcs, and corners that are shaped.
void add_plan(const Drawn& drawn, const Curve& curve, std::size_t second, plot::Plane& plane) {
  const auto farthest = std::ranges::max_element(drawn.nearest, {}, &DrawnPath::Nearest::distance);
  if (farthest == drawn.nearest.end() || farthest->distance < DrawnPath::rounding) return;
  const auto away = [&](std::size_t i, std::size_t axis) {
    return std::lerp(drawn.nearest[i].point[axis], curve.positions[i].at(axis), enlarged);
  };
  for (std::size_t i = 0; i < drawn.nearest.size(); ++i) {
    plane.enlarged.x.push_back(away(i, 0));
    plane.enlarged.y.push_back(away(i, second));
  }
  plane.enlarged_name = "ten times off";
  const auto at = static_cast<std::size_t>(farthest - drawn.nearest.begin());
  std::optional<double> exceeded_by;
  if (farthest->distance > drawn.tolerance) exceeded_by = farthest->distance - drawn.tolerance;
  plane.marked = {curve.positions[at].at(0), curve.positions[at].at(second),
                  fmt::format("{} off the drawn line, at {} s, {}", figure(farthest->distance, 3),
                              figure(curve.times_s[at], 4), tolerance_verdict(exceeded_by))};
}

/// What a gateway says of a text that it cannot take, in the subject of an error.
struct Problem {
  TMCL_STRUCT(Problem);
  TMCL_FIELD(std::uint32_t, line, "of the text");
  TMCL_FIELD(std::uint32_t, column, "in the line");
  TMCL_FIELD(std::string, message, "what is wrong");
};
struct OfText {
  TMCL_STRUCT(OfText);
  TMCL_FIELD(std::vector<Problem>, problems, "where it is wrong");
  TMCL_FIELD(std::string, file_axis, "an axis of it that none is named for");
};

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
  const auto told = api::from_json<OfText>(failure.subject);
  tmcl::TextProblems problems;
  for (const auto& problem : told.problems)
    problems.push_back({problem.line, problem.column, problem.message});
  if (!problems.empty()) return error_from(file, problems, tmcl::plan::most_text_problems, output);
  if (!told.file_axis.empty()) failure.hint = fmt::format("--axis {}=NAME", told.file_axis);
  if (failure.name == "bad_path") failure.message = file + ": " + failure.message;
  if (failure.name == "unknown_unit" && failure.hint.empty()) {
    failure.hint =
        "--per-turn says how many units of the file a turn of the motor is; tmcld.toml can, too";
  }
  return failure;
}

void print(const std::string& file, const Course& course, Output& output) {
  output.out << fmt::format("{}: {} units in {} s, {} {}\n\n", file, figure(course.length),
                            figure(course.duration_s, 4), course.legs,
                            course.legs == 1 ? "leg" : "legs");
  Table axes({"AXIS", "FROM", "TO", "TOP SPEED"});
  for (const auto& axis : course.axes)
    axes.add({axis.axis, figure(axis.least), figure(axis.greatest), figure(axis.top_speed)});
  axes.print(output);
  print_corners(course, output);
  print_halts(course, output);
}

void print(const tmcl::api::path::Shaping& shaping, Output& output) {
  const auto text = [](double value) { return tmcl::plain_number(value, 3); };
  output.out << fmt::format(
      "shaped by {} for {} Hz: {} s longer, and at most {} off the path, at {} s\n", shaping.shaper,
      text(shaping.resonance_hz), text(shaping.longer_s), text(shaping.off_path),
      tmcl::plain_number(shaping.off_path_at_s, 4));
  for (const auto& axis : shaping.axes) {
    output.out << fmt::format("  the load of {} swings by {} after it, without the shaper by {}\n",
                              axis.axis, text(axis.swing), text(axis.unshaped_swing));
  }
}

void print(const tmcl::api::path::JerkLimit& limit, Output& output) {
  const auto text = [](double value) { return tmcl::plain_number(value, 3); };
  output.out << fmt::format("with a jerk of {} at most: {} s longer\n",
                            tmcl::plain_number(limit.jerk, 6), text(limit.longer_s));
  for (const auto& axis : limit.axes) {
    output.out << fmt::format("  the load of {} swings by {} after it, without the jerk by {}\n",
                              axis.axis, text(axis.swing), text(axis.unlimited_swing));
  }
}

std::string to_svg(const std::string& file, const Course& course, const Curve& curve,
                   const Drawn& drawn) {
  const auto& axes = course.axes;
  const std::size_t second = std::min<std::size_t>(1, axes.size() - 1);
  plot::Plane plane{title(file, course), axes[0].axis, axes[second].axis, {}, {}};
  for (const auto& position : curve.positions) {
    plane.planned.x.push_back(position.at(0));
    plane.planned.y.push_back(position.at(second));
  }
  if (drawn.passage)
    add(*drawn.passage, second, plane);
  else
    add_plan(drawn, curve, second, plane);
  if (!drawn.shown.empty()) return plot::to_svg(plane, picture_of(course, curve, drawn));
  auto picture = picture_of(course, curve, {{plot::Quantity::position}, {}});
  picture.marks.clear();
  return plot::to_svg(plane, picture);
}

std::string drawing(const std::string& file, const Course& course, const Curve& curve,
                    const Drawn& drawn, const Screen& screen) {
  auto picture = picture_of(course, curve, drawn);
  picture.title = title(file, course);
  return plot::to_text(picture, screen);
}

}  // namespace tmclctl::path

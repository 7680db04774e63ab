#include "api/course_json.hpp"

#include <boost/json/array.hpp>

namespace tmcld {

namespace json = boost::json;
using tmcl::plan::Course;

namespace {

constexpr std::size_t most_corners = 5;

json::array to_json(const tmcl::plan::AxisValues& values, std::size_t axes) {
  return json::array(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(axes));
}

}  // namespace

json::object to_json(const Course& course, const std::vector<std::string>& names) {
  json::array axes;
  for (std::size_t axis = 0; axis < course.axes(); ++axis) {
    axes.push_back(json::object{{"axis", names[axis]},
                                {"least", course.least()[axis]},
                                {"greatest", course.greatest()[axis]},
                                {"top_speed", course.top_speed(axis)}});
  }
  json::array corners;
  for (const auto& corner : course.slowest_corners(most_corners)) {
    corners.push_back(json::object{{"line", corner.line},
                                   {"time_s", corner.time},
                                   {"speed", corner.speed},
                                   {"position", to_json(corner.position, course.axes())}});
  }
  return {{"length", course.length()},
          {"duration_s", course.duration()},
          {"legs", course.legs()},
          {"axes", std::move(axes)},
          {"slowest_corners", std::move(corners)}};
}

json::object curve_json(const Course& course, int points) {
  json::array times;
  json::array positions;
  for (int i = 0; i <= points; ++i) {
    const double time = course.duration() * i / points;
    times.emplace_back(time);
    positions.emplace_back(to_json(course.at(time).position, course.axes()));
  }
  return {{"times_s", std::move(times)}, {"positions", std::move(positions)}};
}

}  // namespace tmcld

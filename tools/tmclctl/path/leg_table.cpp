#include "path/leg_table.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "connection/json_read.hpp"
#include "output/print.hpp"
#include "tmcl/plain_number.hpp"

namespace tmclctl::path {
namespace {

namespace json = boost::json;
using tmcl::plan::AxisRamp;

constexpr std::array ramp_keys{"target", "vstart", "vmax", "vstop", "amax", "dmax"};

json::object ramp_json(const AxisRamp& ramp, double scale) {
  return {{"target", ramp.target * scale}, {"vstart", ramp.vstart * scale},
          {"vmax", ramp.vmax * scale},     {"vstop", ramp.vstop * scale},
          {"amax", ramp.amax * scale},     {"dmax", ramp.dmax * scale}};
}

json::object microsteps_json(const AxisRamp& ramp, double scale) {
  auto ramps = ramp_json(ramp, scale);
  for (auto& [key, value] : ramps) value = std::llround(value.as_double());
  return ramps;
}

void print_ramps(const json::array& legs, const char* title, bool in_microsteps, Output& output) {
  Table table(
      {"LINE", "T1", "T2", "T3", "T4", "AXIS", title, "VSTART", "VMAX", "VSTOP", "AMAX", "DMAX"});
  for (const auto& leg : legs) {
    const auto& row = leg.as_object();
    for (const auto& axis : array_at(row, "axes")) {
      const auto& ramp =
          in_microsteps ? object_at(axis.as_object(), "microsteps") : axis.as_object();
      std::vector<std::string> cells{fmt::format("{}", integer_at<std::size_t>(row, "line"))};
      for (const auto* time : {"t1_s", "t2_s", "t3_s", "t4_s"})
        cells.push_back(fmt::format("{:.4f} s", number_at(row, time).value_or(0)));
      cells.push_back(text_at(axis.as_object(), "axis"));
      for (const auto* key : ramp_keys)
        cells.push_back(tmcl::plain_number(number_at(ramp, key).value_or(0), 6));
      table.add(std::move(cells));
    }
  }
  table.print(output.out);
}

}  // namespace

json::array leg_table(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                      std::optional<double> microsteps_per_unit) {
  json::array legs;
  for (std::size_t i = 0; i < course.legs(); ++i) {
    const auto leg = course.leg(i);
    json::array ramps;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      auto ramp = ramp_json(leg.axis[axis], 1);
      ramp["axis"] = axes[axis];
      if (microsteps_per_unit)
        ramp["microsteps"] = microsteps_json(leg.axis[axis], *microsteps_per_unit);
      ramps.push_back(std::move(ramp));
    }
    legs.push_back(json::object{{"line", leg.line},
                                {"t1_s", leg.begin},
                                {"t2_s", leg.begin + leg.up},
                                {"t3_s", leg.end - leg.down},
                                {"t4_s", leg.end},
                                {"axes", std::move(ramps)}});
  }
  return legs;
}

void print_legs(const json::array& legs, Output& output) {
  output.out << '\n';
  if (legs.empty()) {
    output.out << "A table with times has no legs: its rows are passed when they say.\n";
    return;
  }
  print_ramps(legs, "TO (UNITS)", false, output);
  const auto& first = array_at(legs.front().as_object(), "axes").front().as_object();
  if (!first.contains("microsteps")) return;
  output.out << '\n';
  print_ramps(legs, "TO (MICROSTEPS)", true, output);
}

}  // namespace tmclctl::path

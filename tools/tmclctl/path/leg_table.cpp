#include "path/leg_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "connection/json_read.hpp"
#include "output/print.hpp"
#include "tmcl/parameter_number.hpp"
#include "tmcl/plain_number.hpp"
#include "tmcl/ramp/sixpoint.hpp"

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

// VSTOP is 10 at least, data sheets say.
constexpr std::int64_t least_vstop = 10;

/// f / 2^24 and f^2 / 2^41, data sheets.
json::object registers_json(const AxisRamp& ramp, const ChipScale& chip) {
  constexpr int velocity_bits = 24;
  constexpr int acceleration_bits = 41;
  const auto whole = [&](double value, int bits, double per_second) {
    return std::llround(std::ldexp(std::abs(value) * chip.microsteps_per_unit, bits) / per_second);
  };
  const auto velocity = [&](double value) { return whole(value, velocity_bits, chip.clock_hz); };
  const auto acceleration = [&](double value) {
    const auto nearest = whole(value, acceleration_bits, chip.clock_hz * chip.clock_hz);
    return value == 0 ? nearest : std::max<std::int64_t>(nearest, 1);
  };
  return {{"target", std::llround(ramp.target * chip.microsteps_per_unit)},
          {"vstart", velocity(ramp.vstart)},
          {"vmax", velocity(ramp.vmax)},
          {"vstop", std::max<std::int64_t>(velocity(ramp.vstop), least_vstop)},
          {"amax", acceleration(ramp.amax)},
          {"dmax", acceleration(ramp.dmax)}};
}

/// As the chip calls what a leg calls so. The target comes last: it starts the ramp.
struct LegRegister {
  const char* key;
  std::string_view name;
};
constexpr std::array leg_registers{
    LegRegister{"vstart", "vstart"}, LegRegister{"vmax", "vmax"}, LegRegister{"vstop", "vstop"},
    LegRegister{"amax", "amax"},     LegRegister{"dmax", "dmax"}, LegRegister{"target", "xtarget"}};

std::string rows_in_c(const json::object& registers, std::size_t axis) {
  std::string rows;
  const auto infos = tmcl::ramp::SixPoint::registers();
  for (const auto& [key, name] : leg_registers) {
    const auto& info = infos[tmcl::ramp::find_register(infos, name).value()];
    rows += fmt::format("    {{{}, 0x{:02X}, {}}}, /* {} */\n", axis, info.bits.address,
                        integer_at<std::int64_t>(registers, key), name);
  }
  return rows;
}

// ---- TMCL

consteval std::uint8_t number_in_module(std::string_view name) {
  return tmcl::number_of(tmcl::Family::sixpoint, name);
}
constexpr auto velocity_v1 = number_in_module("velocity_v1");

/// As a module calls what a leg calls so.
struct LegParameter {
  std::string_view key;
  std::uint8_t number;
  std::string_view name;
};
constexpr std::array leg_parameters{
    LegParameter{"vstart", number_in_module("start_velocity"), "start_velocity"},
    LegParameter{"vmax", number_in_module("max_velocity"), "max_velocity"},
    LegParameter{"vstop", number_in_module("stop_velocity"), "stop_velocity"},
    LegParameter{"amax", number_in_module("max_acceleration"), "max_acceleration"},
    LegParameter{"dmax", number_in_module("max_deceleration"), "max_deceleration"}};

std::string sap_line(std::uint8_t number, std::size_t motor, std::int64_t value,
                     std::string_view name) {
  return fmt::format("{:<24}// {}\n", fmt::format("SAP {}, {}, {}", number, motor, value), name);
}

/// Those of the axes that move: what makes their ramps, and then all targets, so that they start
/// together.
std::string leg_in_tmcl(const json::array& axes, bool waits) {
  std::string ramps;
  std::string targets;
  std::string waiting;
  for (std::size_t motor = 0; motor < axes.size(); ++motor) {
    const auto& microsteps = object_at(axes[motor].as_object(), "microsteps");
    const auto value_of = [&](std::string_view key) {
      return integer_at<std::int64_t>(microsteps, key);
    };
    if (value_of("vmax") == 0) continue;
    for (const auto& [key, number, name] : leg_parameters) {
      const auto value = value_of(key);
      ramps += sap_line(number, motor,
                        name == "stop_velocity" ? std::max(value, least_vstop) : value, name);
    }
    targets += sap_line(tmcl::axis_parameter::target_position, motor, value_of("target"),
                        "target_position");
    if (waits) waiting += fmt::format("WAIT POS, {}, 0\n", motor);
  }
  return ramps + targets + waiting;
}

/// Between two legs, where the file lets the axes stand.
std::string wait_in_tmcl(double seconds) {
  constexpr double ticks_per_second = 100;
  const auto ticks = std::llround(seconds * ticks_per_second);
  return ticks > 0 ? fmt::format("WAIT TICKS, 0, {}\n", ticks) : "";
}

/// The greatest value of the register that holds this; of the target there is no need to ask.
std::int64_t greatest_of(std::string_view key) {
  const auto registers = tmcl::ramp::SixPoint::registers();
  const auto index = tmcl::ramp::find_register(registers, key);
  return index ? registers[*index].maximum : std::numeric_limits<std::int32_t>::max();
}

/// `part`: of an axis' row; empty: the row itself, in the units of the file.
void print_ramps(const json::array& legs, const char* title, std::string_view part,
                 Output& output) {
  Table table(
      {"LINE", "T1", "T2", "T3", "T4", "AXIS", title, "VSTART", "VMAX", "VSTOP", "AMAX", "DMAX"});
  for (const auto& leg : legs) {
    const auto& row = leg.as_object();
    for (const auto& axis : array_at(row, "axes")) {
      const auto& ramp = part.empty() ? axis.as_object() : object_at(axis.as_object(), part);
      std::vector<std::string> cells{fmt::format("{}", integer_at<std::size_t>(row, "line"))};
      for (const auto* time : {"t1_s", "t2_s", "t3_s", "t4_s"})
        cells.push_back(fmt::format("{:.4f} s", number_at(row, time).value_or(0)));
      cells.push_back(text_at(axis.as_object(), "axis"));
      for (const auto* key : ramp_keys)
        cells.push_back(tmcl::plain_number(number_at(ramp, key).value_or(0), 6));
      table.add(std::move(cells));
    }
  }
  table.print(output);
}

}  // namespace

json::array leg_table(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                      const std::optional<ChipScale>& scale) {
  json::array legs;
  for (std::size_t i = 0; i < course.legs(); ++i) {
    const auto leg = course.leg(i);
    json::array ramps;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      auto ramp = ramp_json(leg.axis[axis], 1);
      ramp["axis"] = axes[axis];
      if (scale) {
        ramp["microsteps"] = microsteps_json(leg.axis[axis], scale->microsteps_per_unit);
        ramp["registers"] = registers_json(leg.axis[axis], *scale);
      }
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

std::string legs_in_c(const json::array& legs, const ChipScale& scale) {
  std::string rows;
  std::string names;
  for (const auto& leg : legs) {
    const auto& row = leg.as_object();
    rows += fmt::format("    /* line {}, {:.4f} s to {:.4f} s */\n",
                        integer_at<std::size_t>(row, "line"), number_at(row, "t1_s").value_or(0),
                        number_at(row, "t4_s").value_or(0));
    const auto& axes = array_at(row, "axes");
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const auto& axis = axes[i].as_object();
      rows += rows_in_c(object_at(axis, "registers"), i);
      if (&leg == &legs.front())
        names += fmt::format("{}{} {}", names.empty() ? "" : ", ", i, text_at(axis, "axis"));
    }
  }
  return fmt::format(
      "/* For a TMC5130, TMC5160 or TMC5072 at {:.0f} Hz, first motor, rampmode 0, v1 0.\n"
      "   Axes: {}. All of a leg is written at its beginning, each xtarget last. */\n"
      "static const struct {{\n"
      "  unsigned char axis;\n"
      "  unsigned char address;\n"
      "  long value;\n"
      "}} legs[] = {{\n{}}};\n",
      scale.clock_hz, names, rows);
}

std::string legs_in_tmcl(const json::array& legs, bool is_program) {
  std::string rows;
  double end = 0;
  for (const auto& leg : legs) {
    const auto& row = leg.as_object();
    const double begin = number_at(row, "t1_s").value_or(0);
    if (is_program) rows += wait_in_tmcl(begin - end);
    end = number_at(row, "t4_s").value_or(0);
    rows += fmt::format("// line {}, {:.4f} s to {:.4f} s\n", integer_at<std::size_t>(row, "line"),
                        begin, end);
    rows += leg_in_tmcl(array_at(row, "axes"), is_program);
  }
  std::string names;
  std::string once;
  const auto& axes = array_at(legs.front().as_object(), "axes");
  for (std::size_t motor = 0; motor < axes.size(); ++motor) {
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", motor,
                         text_at(axes[motor].as_object(), "axis"));
    once += sap_line(velocity_v1, motor, 0, "velocity_v1");
  }
  const auto heading = fmt::format(
      "// For a module with a TMC5130, TMC5160 or TMC5072, whose motors stand where the path "
      "begins.\n"
      "// Motors: {}. All of a leg is written at its beginning, the targets last.\n",
      names);
  return heading + once + rows + (is_program ? "STOP\n" : "");
}

std::vector<plot::Mark> phases_of(const tmcl::plan::Course& course) {
  constexpr std::size_t most_marked_legs = 4;
  std::vector<plot::Mark> phases;
  for (std::size_t i = 0; i < course.legs() && course.legs() <= most_marked_legs; ++i) {
    const auto leg = course.leg(i);
    for (const auto& [time, name] : {std::pair{leg.begin, "T1"},
                                     {leg.begin + leg.up, "T2"},
                                     {leg.end - leg.down, "T3"},
                                     {leg.end, "T4"}})
      phases.push_back({time, name});
  }
  return phases;
}

void print_legs(const json::array& legs, Output& output) {
  output.out << '\n';
  if (legs.empty()) {
    output.out << "A table with times has no legs: its rows are passed when they say.\n";
    return;
  }
  print_ramps(legs, "TO (UNITS)", {}, output);
  const auto& first = array_at(legs.front().as_object(), "axes").front().as_object();
  if (!first.contains("microsteps")) return;
  output.out << '\n';
  print_ramps(legs, "TO (MICROSTEPS)", "microsteps", output);
  output.out << "\nAs the registers of a TMC5130, TMC5160 or TMC5072 hold them:\n";
  print_ramps(legs, "XTARGET", "registers", output);
}

std::vector<std::string> beyond_registers(const json::array& legs, const ChipScale& scale) {
  std::vector<std::string> warnings;
  std::set<std::string> told;
  for (const auto& leg : legs) {
    for (const auto& axis : array_at(leg.as_object(), "axes")) {
      const auto name = text_at(axis.as_object(), "axis");
      const auto& registers = object_at(axis.as_object(), "registers");
      for (const auto* key : ramp_keys) {
        const auto value = number_at(registers, key).value_or(0);
        const auto greatest = static_cast<double>(greatest_of(key));
        if (std::abs(value) <= greatest || !told.insert(name).second) continue;
        const auto share = std::exp2(std::ceil(std::log2(std::abs(value) / greatest)));
        warnings.push_back(fmt::format(
            "line {}: {} of {} would be {}, and its register holds {} at most; with fewer "
            "microsteps it fits: --microsteps-per-unit {} at most",
            integer_at<std::size_t>(leg.as_object(), "line"), key, name, tmcl::plain_number(value),
            tmcl::plain_number(greatest), tmcl::plain_number(scale.microsteps_per_unit / share)));
      }
    }
  }
  return warnings;
}

}  // namespace tmclctl::path

/// The legs of a course in the parameters of ramp generators: when each speeds up and slows down,
/// and what each axis does meanwhile.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <boost/json/array.hpp>

#include "output/screen.hpp"
#include "plot/curve.hpp"
#include "tmcl/plan/course.hpp"

namespace tmclctl::path {

/// What the registers of a chip count in.
struct ChipScale {
  double microsteps_per_unit = 1;
  double clock_hz = 16e6;
};

/// A row for each leg: t1 where it begins, t2 where it has its speed, t3 where it slows down, t4
/// where it ends, and for each axis its target and ramp; with a scale in microsteps, too, and as
/// the registers of a TMC5130, TMC5160 or TMC5072 hold them.
boost::json::array leg_table(const tmcl::plan::Course& course, const std::vector<std::string>& axes,
                             const std::optional<ChipScale>& scale);
void print_legs(const boost::json::array& legs, Output& output);
/// Of ramps that are beyond the registers: the first of each axis, and what would do.
std::vector<std::string> beyond_registers(const boost::json::array& legs, const ChipScale& scale);

/// What is to be written for each leg, as a table in C: of legs with registers.
std::string legs_in_c(const boost::json::array& legs, const ChipScale& scale);
/// The same as lines of TMCL, for a module that counts in microsteps and seconds: motor 0 is the
/// first axis. A program waits after each leg until its axes are there, and ends.
std::string legs_in_tmcl(const boost::json::array& legs, bool is_program);
/// T1 to T4 of each leg, where there are few; nothing otherwise.
std::vector<plot::Mark> phases_of(const tmcl::plan::Course& course);

}  // namespace tmclctl::path

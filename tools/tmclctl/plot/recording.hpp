/// What was seen of an axis over time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plot/curve.hpp"
#include "plot/shown.hpp"
#include "tmcl/clock.hpp"
#include "tmcl/conversion.hpp"

namespace tmclctl::plot {

/// What a further parameter was when a sample was taken.
struct ParameterValue {
  std::int32_t value = 0;
  std::optional<double> in_unit{};
  std::int64_t age_ms = 0;  ///< Below 0: it was read after the position.
};

struct Sample {
  double time = 0;
  std::int64_t position = 0;
  std::int64_t velocity = 0;
  double took = 0;  ///< To read it: it is of some instant between `time` and `took` later.
  std::optional<std::int64_t> acceleration{};  ///< Of a generator; of all samples, or of none.
  /// Of Recording::also, in its order; nothing for what was not read yet. May be empty.
  std::vector<std::optional<ParameterValue>> also{};
};

/// A parameter that is recorded beside position and velocity.
struct AlsoRecorded {
  std::string name;
  std::string unit{};  ///< What it is in the unit of the axis; empty: none.
};

/// What an axis that has a unit of its own is drawn in.
struct UserUnit {
  tmcl::UserScale scale;
  tmcl::ModuleUnits module;
};

struct Recording {
  std::string axis;
  std::vector<Sample> samples;  ///< Ascending by time.
  std::string time_unit = "s";
  std::string position_unit = "microsteps";
  std::string velocity_unit = "internal";
  std::optional<UserUnit> user{};  ///< Nothing: it is drawn in what it was recorded in.
  /// What the time of day was at 0 s; nothing if that is unknown.
  std::optional<tmcl::UtcTime> begin_utc{};
  std::vector<Mark> phases{};  ///< Where each begins, if that is known.
  std::vector<AlsoRecorded> also{};
};

/// Draws it in the unit of its axis from now on.
void use(UserUnit unit, Recording& recording);

/// What was recorded, in the units that the recording is drawn in.
double shown_position(double recorded, const Recording& recording);
double shown_velocity(double recorded, const Recording& recording);

Curve position_curve(const Recording& recording);
Curve velocity_curve(const Recording& recording);
/// What was not recorded is how fast the velocity changes.
Curve acceleration_curve(const Recording& recording);
/// How fast the acceleration changes in each phase. Where it jumps, there is no jerk to draw.
Curve jerk_curve(const Recording& recording);
/// One for each further parameter: in the unit of the axis if it has one there.
std::vector<Curve> also_curves(const Recording& recording);

/// "x went from 0 to 51200 microsteps in 3.42 s, fastest velocity 1000 [internal]"; to the left it
/// is below 0.
std::string summary(const Recording& recording);

/// A line of column names, and one line for each sample; of a recording in the usual units. What is
/// drawn in the unit of the axis has two more columns with that, and the last one is the time of
/// day if that is known. Before it are further parameters, each with its age, and acceleration and
/// jerk if they are shown.
std::string to_csv(const Recording& recording, const Shown& shown = {});

/// Rows of one axis, or of several, whose units differ: each row names its axis then, and columns
/// are called "in_unit".
enum class Rows : std::uint8_t { of_one, of_several };
/// The line of column names.
std::string csv_columns(const Recording& recording, Rows rows);
/// The line of one sample.
std::string csv_row(const Recording& recording, const Sample& sample, Rows rows);

}  // namespace tmclctl::plot

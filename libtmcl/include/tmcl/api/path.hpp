/// The methods of several axes that move together.
#pragma once

#include "tmcl/api/program.hpp"

namespace tmcl::api {

namespace line {

constexpr std::string_view limit_summary =
    "what no axis exceeds; a number: in the unit that all have";

struct LineAxis {
  TMCL_STRUCT(LineAxis);
  TMCL_FIELD(std::string, axis, axis::axis_summary);
  TMCL_FIELD(std::int32_t, target_microsteps, "where it is to go");
  TMCL_FIELD(std::optional<double>, target, "the same in its unit");
  TMCL_FIELD(std::optional<std::string>, unit, axis::unit_summary);
  TMCL_FIELD(double, predicted_s, "when it arrives");
};
struct StartedLine {
  TMCL_STRUCT(StartedLine);
  TMCL_FIELD(std::vector<LineAxis>, axes, "its axes, in the order of the request");
  TMCL_FIELD(double, predicted_s, "when the last of them arrives");
  TMCL_FIELD(double, spread_s, "how much earlier the first of them does, as predicted");
  TMCL_FIELD(double, deviation,
             "how far off the line they get, as predicted; a part of the longest way");
  TMCL_FIELD(bool, one_command, "one command has started them all");
  TMCL_FIELD(double, predicted_skew_s, "how long the starts were expected to take");
  TMCL_FIELD(double, skew_s, "from the first start to the last, as the answers tell");
  TMCL_FIELD(std::optional<std::vector<std::string>>, warnings,
             "warnings about the settings of its axes");
};
struct Move {
  TMCL_METHOD("line.move", moves, StartedLine,
              "moves several axes so that they start and arrive together", Move);
  TMCL_FIELD(std::vector<std::string>, axes, "names of the axes, on any buses");
  TMCL_FIELD(std::optional<std::vector<std::int32_t>>, positions_microsteps,
             "where each of them is to go");
  TMCL_FIELD(std::optional<std::vector<Amount>>, positions, axis::in_unit_summary);
  TMCL_FIELD(std::optional<Amount>, velocity, limit_summary);
  TMCL_FIELD(std::optional<double>, velocity_pps, "the same in microsteps per second, instead");
  TMCL_FIELD(std::optional<Amount>, acceleration, limit_summary);
  TMCL_FIELD(std::optional<double>, acceleration_pps2,
             "the same in microsteps per second squared, instead");
  TMCL_FIELD(std::optional<double>, time_s,
             "how long it takes, up to 86400; as short as possible if absent");
  TMCL_FIELD(std::optional<std::int64_t>, deadline_ms, axis::deadline_summary, axis::milliseconds);
};

}  // namespace line

namespace path {

constexpr std::size_t most_bytes = std::size_t{16} << 20U;

struct Stage {
  TMCL_METHOD("path.stage", reads, HandedOver, "hands over the next part of a path file", Stage);
  TMCL_FIELD(std::int32_t, offset, "how many bytes were handed over before; 0: a new path",
             {0, most_bytes});
  TMCL_FIELD(std::string, data, data_summary);
};

struct Curve {
  TMCL_STRUCT(Curve);
  TMCL_FIELD(std::vector<double>, times_s, "of its points");
  TMCL_FIELD(std::vector<std::vector<double>>, positions, "of each axis at each of them");
};
/// How far an axis was seen off its plan, in the unit of the file.
struct Tracking {
  TMCL_STRUCT(Tracking);
  TMCL_FIELD(double, largest, "how far off its plan it was seen");
  TMCL_FIELD(double, rms, "root of the mean square");
  TMCL_FIELD(std::uint64_t, readings, "how often it was looked at");
  TMCL_FIELD(std::string, axis, axis::axis_summary);
};
/// Where the encoders of its axes saw them.
struct MotorPassage {
  TMCL_STRUCT(MotorPassage);
  TMCL_FIELD(std::vector<Tracking>, tracking_error, "of each axis that has an encoder");
  TMCL_FIELD(
      double, off_path,
      "how far from the path the motors were seen at most, in the unit of the file; where an axis "
      "has no encoder, its position counts");
  TMCL_FIELD(double, off_path_at_s, "when that was, in seconds of the course");
  TMCL_FIELD(std::vector<double>, off_path_at, "where each motor was then");
  TMCL_FIELD(double, lag_s, "how late on the path they were seen at most");
  TMCL_FIELD(std::optional<double>, tolerance_exceeded_by,
             "by how much off_path is more than the tolerance, at least; null if it is not");
  TMCL_FIELD(std::optional<Curve>, seen,
             "where the motors were seen, over the course; null unless points are asked for");
  TMCL_FIELD(std::optional<Curve>, on_path, "the nearest point of the path to each of these");
};
/// As far as it has been passed.
struct Passage {
  TMCL_STRUCT(Passage);
  TMCL_FIELD(double, passed_s, "how long it took");
  TMCL_FIELD(std::uint64_t, updates, "of velocities; of segments; legs in position mode");
  TMCL_FIELD(
      double, period_ms,
      "between updates; the least that a segment takes; of the shortest leg in position mode");
  TMCL_FIELD(double, worst_delay_ms, "of an update, or of the load of a leg");
  TMCL_FIELD(std::uint64_t, commands, "sent meanwhile");
  TMCL_FIELD(double, commands_per_s, "of them");
  TMCL_FIELD(double, bus_load, "part of the time that they took");
  TMCL_FIELD(double, round_trip_us, "of a command, measured before");
  TMCL_FIELD(std::vector<Tracking>, tracking_error, "of each axis");
  TMCL_FIELD(
      double, off_path,
      "how far from the path the axes were seen at most, in the unit of the file; between two "
      "readings they may have been farther off");
  TMCL_FIELD(double, off_path_at_s, "when that was, in seconds of the course");
  TMCL_FIELD(std::vector<double>, off_path_at, "where each axis was then");
  TMCL_FIELD(double, lag_s, "how late on the path they were seen at most");
  TMCL_FIELD(std::optional<double>, tolerance_exceeded_by,
             "by how much off_path is more than the tolerance, at least; null if it is not");
  TMCL_FIELD(std::vector<std::string>, remarks,
             "what else is to be said, such as of a parameter not set back");
  TMCL_FIELD(std::optional<Curve>, seen,
             "where the axes were seen, over the course; null unless points are asked for");
  TMCL_FIELD(std::optional<Curve>, on_path, "the nearest point of the path to each of these");
  TMCL_FIELD(std::optional<MotorPassage>, motors,
             "the same by the encoders of the axes; null unless the configuration names one, and "
             "it was read");
};
/// What the axes are expected to make of it in a mode, by their twins.
struct Expected {
  TMCL_STRUCT(Expected);
  TMCL_FIELD(std::string, mode, "velocity, segments or position");
  TMCL_FIELD(double, off_path, "how far from the path the axes get, in the unit of the file");
  TMCL_FIELD(double, off_path_at_s, "when they are so far off, in seconds of the course");
  TMCL_FIELD(std::vector<double>, off_path_at, "where each axis is then");
  TMCL_FIELD(double, lag_s, "how late on the path they get");
  TMCL_FIELD(double, foreseen_s,
             "how much of the course was foreseen; of a long one only the beginning");
  TMCL_FIELD(bool, keeps_tolerance, "whether off_path stays within the tolerance");
  TMCL_FIELD(std::optional<std::string>, refused,
             "why the path cannot be passed in this mode, or would be ended; null if it can");
};
struct Passed : Passage {
  TMCL_STRUCT(Passed, Passage);
  TMCL_FIELD(std::vector<std::string>, warnings,
             "warnings about the settings of its axes, and what of the file is not carried out");
  TMCL_FIELD(
      std::vector<Expected>, expected,
      "what was expected before it began, as path.plan says; empty of a path that was planned "
      "before");
};
/// What is to be passed, and how.
struct OfPath {
  TMCL_STRUCT(OfPath);
  TMCL_FIELD(std::optional<std::vector<std::string>>, axes,
             "names of axes that stand, each once; path.plan takes those of the same name as the "
             "file's if absent");
  TMCL_FIELD(std::optional<std::vector<std::string>>, file_axes,
             "which axis of the file each of them is; in the file's order if absent");
  TMCL_FIELD(std::optional<std::string>, text, "the file");
  TMCL_FIELD(std::optional<std::uint32_t>, bytes,
             "how many were handed over by path.stage, instead", {1, most_bytes});
  TMCL_FIELD(std::optional<std::string>, format, "csv or gcode; as the text looks if absent");
  TMCL_FIELD(std::optional<std::string>, mode,
             "velocity, segments or position; velocity if absent");
  TMCL_FIELD(std::optional<double>, tolerance,
             "how far from it the path may be passed, in the file's unit; 0.05 if absent");
  TMCL_FIELD(std::optional<Amount>, velocity,
             "no axis faster than this; a number: in the file's unit a second; its max_velocity if "
             "absent");
  TMCL_FIELD(std::optional<Amount>, acceleration,
             "the same, a second squared; the least of its own if absent");
  TMCL_FIELD(std::optional<Amount>, feed,
             "no faster along the path; a number: in the file's unit a second");
  TMCL_FIELD(std::optional<Amount>, corner_jump,
             "by how much the speed of an axis may change at once in a corner, in the same units");
  TMCL_FIELD(std::optional<double>, per_turn,
             "what a turn of the motor is, for axes without a unit");
  TMCL_FIELD(std::optional<double>, deviation,
             "stop when an axis is seen so far off its plan; 20 tolerances if absent");
  TMCL_FIELD(std::optional<std::int32_t>, period_ms,
             "in velocity mode, and by segments, no updates more often than this; 5 if absent",
             {5, 1000});
  TMCL_FIELD(std::optional<bool>, lenient,
             "whether words of G-code that are not known are skipped, with warnings; refused if "
             "absent");
  TMCL_FIELD(std::optional<std::string>, name,
             "by what path.status tells it from others, such as the name of its file");
  TMCL_FIELD(
      std::optional<std::string>, shaper,
      "zv, zvd or ei: passes the path so that loads which swing at resonance_hz hardly swing "
      "after it; takes up to a swing longer, and cuts corners; not in position mode");
  TMCL_FIELD(std::optional<double>, resonance_hz,
             "for shaper, and for what is told of jerk: as axis.resonance measures it");
  TMCL_FIELD(std::optional<double>, damping, "of those swings, 0 to less than 1; 0.05 if absent");
  TMCL_FIELD(
      std::optional<Amount>, jerk,
      "by how much the acceleration along the path changes in a second, at most; a number: in "
      "the file's unit a second cubed; no limit if absent; not in position mode, not for a "
      "table with times");
};
struct CourseAxis {
  TMCL_STRUCT(CourseAxis);
  TMCL_FIELD(std::string, axis, "of the file");
  TMCL_FIELD(double, least, "least position of it");
  TMCL_FIELD(double, greatest, "greatest position");
  TMCL_FIELD(double, top_speed, "how fast it gets");
};
struct Corner {
  TMCL_STRUCT(Corner);
  TMCL_FIELD(std::uint64_t, line, "of the file");
  TMCL_FIELD(double, time_s, "when it is passed");
  TMCL_FIELD(double, speed, "along the path");
  TMCL_FIELD(std::vector<double>, position, "of each axis");
};
/// An M word of G-code.
struct CarriedOut {
  TMCL_STRUCT(CarriedOut);
  TMCL_FIELD(std::uint8_t, number, "of the word: 3, 4, 5, 7, 8 or 9");
  TMCL_FIELD(std::uint64_t, times, "how often it is carried out");
  TMCL_FIELD(std::uint64_t, line, "of the file, for the first time");
  TMCL_FIELD(std::string, switches, "what it switches, as the configuration says it");
};
/// In the units of the file.
struct Course {
  TMCL_STRUCT(Course);
  TMCL_FIELD(double, length, "of the path");
  TMCL_FIELD(double, duration_s, "how long it takes");
  TMCL_FIELD(std::uint64_t, legs, "how many it has");
  TMCL_FIELD(std::vector<CourseAxis>, axes, "of the file");
  TMCL_FIELD(std::vector<Corner>, slowest_corners, "where it gets slowest; five at most");
  TMCL_FIELD(std::vector<CarriedOut>, words, "which M words are carried out on it");
  TMCL_FIELD(std::uint64_t, waits, "how often it waits at M0 until path.resume");
};
struct ShapedAxis {
  TMCL_STRUCT(ShapedAxis);
  TMCL_FIELD(std::string, axis, "of the file");
  TMCL_FIELD(double, swing, "of its load after the path, to either side");
  TMCL_FIELD(double, unshaped_swing, "the same without the shaper");
};
/// In the units of the file.
struct Shaping {
  TMCL_STRUCT(Shaping);
  TMCL_FIELD(std::string, shaper, "zv, zvd or ei");
  TMCL_FIELD(double, resonance_hz, "which it is for");
  TMCL_FIELD(double, damping, "of those swings");
  TMCL_FIELD(double, longer_s, "than the path takes without it");
  TMCL_FIELD(double, off_path, "how far it leaves the path at most: it cuts corners");
  TMCL_FIELD(double, off_path_at_s, "when that is, in seconds of the course");
  TMCL_FIELD(std::vector<ShapedAxis>, axes, "what it leaves of their swings");
};
struct JerkAxis {
  TMCL_STRUCT(JerkAxis);
  TMCL_FIELD(std::string, axis, "of the file");
  TMCL_FIELD(double, swing, "of its load after the path, to either side");
  TMCL_FIELD(double, unlimited_swing, "the same without the jerk");
};
/// In the units of the file.
struct JerkLimit {
  TMCL_STRUCT(JerkLimit);
  TMCL_FIELD(double, jerk, "along the path, at most");
  TMCL_FIELD(double, longer_s, "than the path takes without it");
  TMCL_FIELD(std::optional<double>, resonance_hz, "of the loads that are told of; null: none");
  TMCL_FIELD(std::vector<JerkAxis>, axes, "what it leaves of their swings");
};
struct Planned {
  TMCL_STRUCT(Planned);
  TMCL_FIELD(std::int32_t, plan, "by which path.run runs it, once; the daemon keeps the last one");
  TMCL_FIELD(std::vector<std::string>, axes, "in the order of the file's");
  TMCL_FIELD(Course, course, "where it leads, and how fast");
  TMCL_FIELD(std::optional<Curve>, curve, "to draw it; null unless points are asked for");
  TMCL_FIELD(std::vector<Expected>, expected,
             "what is expected in each mode, the one that was asked for first; empty where the "
             "ramps of an axis are not described");
  TMCL_FIELD(std::vector<std::string>, warnings,
             "warnings about the settings of its axes, and what of the file is not carried out");
  TMCL_FIELD(std::optional<Shaping>, shaping, "what the shaper makes of it; null without one");
  TMCL_FIELD(std::optional<JerkLimit>, jerk, "what the jerk makes of it; null without one");
};
/// So many points at most: an answer has to be sent.
constexpr int most_curve_points = 2000;
struct Plan : OfPath {
  TMCL_METHOD("path.plan", reads, Planned, "plans a path, and says what will be run", Plan, OfPath);
  TMCL_FIELD(std::optional<std::int32_t>, points, "how many of the curve are given; none if absent",
             {0, most_curve_points});
};
struct Run : OfPath {
  TMCL_METHOD(
      "path.run", moves, Passed,
      "moves axes along a path and answers at its end; tells its progress by notify_progress", Run,
      OfPath);
  TMCL_FIELD(std::optional<std::int32_t>, plan,
             "what path.plan has planned, instead of all but to_start and points");
  TMCL_FIELD(std::optional<bool>, to_start,
             "whether the axes go to the start first; they must stand there if absent");
  TMCL_FIELD(std::optional<std::int32_t>, points,
             "how many of the places where the axes are seen are given, to draw them; none if "
             "absent",
             {0, most_curve_points});
};

/// The paths of some axes.
struct OnPaths {
  TMCL_STRUCT(OnPaths);
  TMCL_FIELD(std::optional<std::vector<std::string>>, axes, "of paths; all paths if absent");
};
struct PathAxes {
  TMCL_STRUCT(PathAxes);
  TMCL_FIELD(std::vector<std::string>, axes, "of the paths concerned");
};
struct Pause : OnPaths {
  TMCL_METHOD("path.pause", writes, PathAxes, "lets axes stand on their path", Pause, OnPaths);
};
struct Resume : OnPaths {
  TMCL_METHOD("path.resume", moves, PathAxes, "lets them go on, also from M0", Resume, OnPaths);
};
/// Of a path that is passed. Speeds are along it, in the unit of its file a second.
struct RunningPath {
  TMCL_STRUCT(RunningPath);
  TMCL_FIELD(std::vector<std::string>, axes, "in the order of the file's");
  TMCL_FIELD(std::optional<std::string>, name, "what path.run calls it");
  TMCL_FIELD(std::string, mode, "velocity, segments or position");
  TMCL_FIELD(std::string, phase, "approaching, measuring, running, pausing, waiting or ending");
  TMCL_FIELD(double, passed_s, "how much of its course has been passed, in seconds of that");
  TMCL_FIELD(double, duration_s, "how long the course takes as it was planned");
  TMCL_FIELD(double, done, "what part of it has been passed; 0 to 1");
  TMCL_FIELD(
      std::optional<double>, left_s,
      "how long the rest takes with the present override, or with 1 if that is greater; null "
      "while it is held");
  TMCL_FIELD(std::optional<std::uint64_t>, line,
             "of the file, on which it is; null in a table with times");
  TMCL_FIELD(bool, held, "whether it stands on its path, or is about to");
  TMCL_FIELD(double, factor, "the override: what part of the planned speed is asked for");
  TMCL_FIELD(double, factor_now,
             "what there is of it now; less than is asked for while it changes, and where an axis "
             "can do no more");
  TMCL_FIELD(double, planned_feed, "the speed that the course has here");
  TMCL_FIELD(double, feed, "the speed that there is: factor_now of it");
  TMCL_FIELD(double, off_path, "how far from the path the axes were seen so far");
  TMCL_FIELD(double, off_path_at_s, "when that was, in seconds of the course");
  TMCL_FIELD(double, lag_s, "how late on the path they were seen so far");
  TMCL_FIELD(std::optional<std::uint64_t>, waits_at_line,
             "of the file, of the M0 at which it waits until path.resume; null if it does not");
};
struct RunningPaths {
  TMCL_STRUCT(RunningPaths);
  TMCL_FIELD(std::vector<RunningPath>, paths, "those concerned");
};
struct Status : OnPaths {
  TMCL_METHOD("path.status", reads, RunningPaths,
              "how far the paths of some axes are, and how fast", Status, OnPaths);
};
struct Feed : OnPaths {
  TMCL_METHOD("path.feed", moves, RunningPaths,
              "slows paths down, speeds them up, holds them and lets them go on", Feed, OnPaths);
  TMCL_FIELD(std::optional<double>, factor,
             "the override, 0.1 to 2: what part of the planned speed is asked for");
  TMCL_FIELD(std::optional<bool>, hold, "whether they stand on their path; false: they go on");
};
struct Stop : OnPaths {
  TMCL_METHOD("path.stop", stops, PathAxes,
              "ends paths: answers when their axes stand and have their settings again", Stop,
              OnPaths);
};

}  // namespace path

namespace mint {

struct Group {
  TMCL_STRUCT(Group);
  TMCL_FIELD(std::int32_t, line, "of its GO");
  TMCL_FIELD(double, planned_s, "how long it was to take");
  TMCL_FIELD(double, took_s, "how long it took");
};
struct Ran {
  TMCL_STRUCT(Ran);
  TMCL_FIELD(std::vector<Group>, groups, "one for each GO");
  TMCL_FIELD(std::vector<std::string>, remarks,
             "what else is to be said, such as of a parameter not set back");
};
struct Run {
  TMCL_METHOD("mint.run", moves, Ran,
              "moves axes as a Mint program says and answers at its end; tells its progress by "
              "notify_progress",
              Run);
  TMCL_FIELD(std::vector<std::string>, axes, "names of axes that stand; each once");
  TMCL_FIELD(std::optional<std::vector<std::uint8_t>>, numbers,
             "which axis of the program each of them is; 0, 1, ... if absent", {0, 7});
  TMCL_FIELD(std::optional<std::string>, counts,
             "what SCALE counts: microsteps or encoder, its counts; microsteps if absent");
  TMCL_FIELD(std::optional<std::string>, text, "the program");
  TMCL_FIELD(std::optional<std::uint32_t>, bytes,
             "how many were handed over by path.stage, instead", {1, path::most_bytes});
};

}  // namespace mint
}  // namespace tmcl::api

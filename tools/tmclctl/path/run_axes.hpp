/// The axes that a path is run on: what they count in, and what they may do.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "path/path_source.hpp"
#include "target.hpp"
#include "tmcl/plan/stream.hpp"

namespace tmclctl::path {

/// "X=left": which axis of the file is which axis.
struct AxisChoice {
  std::string of_file;
  std::string axis;
};

struct RunAxis {
  std::string of_file;
  std::string name;
  tmcl::plan::StreamAxis stream;
  std::optional<tmcl::SoftLimits> soft_limits;
  tmcl::ValueRange range;  ///< Of positions, in microsteps.
  // What its parameters allow, in the file's units.
  double velocity = 0;
  double acceleration = 0;
};

struct RunWish {
  tmcl::plan::StreamMode mode = tmcl::plan::StreamMode::velocity;
  double tolerance = 0;
  std::optional<double> velocity, acceleration, feed;  ///< In the file's units.
  std::optional<double> per_turn;  ///< The file's units of a motor's turn, for axes without a unit.
};

/// In the order of the file's axes. Errors: axes that were not chosen or are not in the file; what
/// is not known of an axis; an axis whose unit is not the file's, that moves, or that may not do
/// what this mode needs.
Attempt<std::vector<RunAxis>> read_axes(const Source& source,
                                        const std::vector<AxisChoice>& choices, const RunWish& wish,
                                        Target& target);
tmcl::plan::PathLimits limits_of(const std::vector<RunAxis>& axes, const RunWish& wish);
/// Whether every point is where the axes can and may go.
Attempt<void> check_reach(const tmcl::plan::Course& course, const std::vector<RunAxis>& axes);

/// How many microsteps a unit is; negative for an axis that counts the other way.
Attempt<double> microsteps_of_unit(const AxisUnits& units, std::optional<double> per_turn);
tmcl::Microsteps microsteps(const RunAxis& axis, double position);
Failure impossible(std::string name, std::string message, std::string hint = {});

}  // namespace tmclctl::path

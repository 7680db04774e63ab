/// What was seen of an axis over time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tmclctl::plot {

struct Sample {
  double time_s = 0;
  std::int32_t position_microsteps = 0;
  std::int32_t velocity_internal = 0;
};

struct Recording {
  std::string axis;
  std::vector<Sample> samples;  ///< Ascending by time.
};

/// One curve of a recording.
struct Curve {
  std::string name;
  std::string unit;
  std::vector<double> times;
  std::vector<double> values;
};

Curve position_curve(const Recording& recording);
Curve velocity_curve(const Recording& recording);

/// "x went from 0 to 51200 microsteps in 3.42 s, greatest velocity 1000"
std::string summary(const Recording& recording);

/// A line of column names, and one line for each sample.
std::string to_csv(const Recording& recording);

}  // namespace tmclctl::plot

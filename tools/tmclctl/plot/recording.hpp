/// What was seen of an axis over time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tmclctl::plot {

struct Sample {
  double time = 0;
  std::int64_t position = 0;
  std::int64_t velocity = 0;
  double took = 0;  ///< To read it: it is of some instant between `time` and `took` later.
};

struct Recording {
  std::string axis;
  std::vector<Sample> samples;  ///< Ascending by time.
  std::string time_unit = "s";
  std::string position_unit = "microsteps";
  std::string velocity_unit = "internal";
};

/// One curve of a recording.
struct Curve {
  std::string name;
  std::string unit;
  std::vector<double> times;
  std::vector<double> values;
  std::vector<double> planned{};  ///< What the values should have been; may be empty.
};

Curve position_curve(const Recording& recording);
Curve velocity_curve(const Recording& recording);

/// "x went from 0 to 51200 microsteps in 3.42 s, greatest velocity 1000"
std::string summary(const Recording& recording);

/// A line of column names, and one line for each sample; of a recording in the usual units.
std::string to_csv(const Recording& recording);

}  // namespace tmclctl::plot

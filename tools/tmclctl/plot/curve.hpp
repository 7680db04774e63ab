/// What is drawn over time.
#pragma once

#include <string>
#include <vector>

namespace tmclctl::plot {

/// Another movement beside the one that a curve is of.
struct Overlay {
  std::string label;
  std::vector<double> times;
  std::vector<double> values;
  bool dotted = false;
};

struct Curve {
  std::string name;
  std::string unit;
  std::vector<double> times;  ///< Ascending; twice the same where the value jumps.
  std::vector<double> values;
  std::vector<double> planned{};    ///< What the values should have been; may be empty.
  std::string colour_of{};          ///< Drawn like the curve of this name; empty: like its own.
  std::vector<Overlay> overlays{};  ///< most_overlays at most.
};
constexpr std::size_t most_overlays = 4;

/// A time that is pointed out.
struct Mark {
  double time;
  std::string label;
};

/// Those of the curve and of what is drawn with it.
std::vector<double> all_times(const Curve& curve);
std::vector<double> all_values(const Curve& curve);

/// How fast the values change, in their unit a unit of time: the mean over some points to both
/// sides, but not beyond a break. A value that jumps there, or at an end of a curve that has
/// breaks, has no slope.
Curve derivative(const Curve& of, std::string name, std::string unit,
                 const std::vector<double>& breaks);

}  // namespace tmclctl::plot

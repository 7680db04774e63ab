/// From values to places on an axis, with ticks at round numbers.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tmclctl::plot {

class Scale {
 public:
  /// Spans the values, and never nothing. At least two ticks, and about `ticks_wished`.
  Scale(std::span<const double> values, int ticks_wished);

  double low() const { return low_; }
  double high() const { return high_; }
  /// 0 at the low end, 1 at the high end.
  double fraction(double value) const { return (value - low_) / (high_ - low_); }
  const std::vector<double>& ticks() const { return ticks_; }
  /// With as many decimals as the distance of the ticks needs.
  std::string label(double tick) const;

 private:
  double low_ = 0;
  double high_ = 1;
  int decimals_ = 0;
  std::vector<double> ticks_;
};

}  // namespace tmclctl::plot

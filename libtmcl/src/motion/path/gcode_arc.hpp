/// Where the centre of an arc of G-code is, and how far it turns.
#pragma once

#include <array>
#include <string>

#include <tl/expected.hpp>

namespace tmcl::plan::path_file::gcode {

constexpr double mm_of_an_inch = 25.4;

/// In its plane, in mm; counter-clockwise leads from the first axis to the second.
struct PlaneArc {
  using Place = std::array<double, 2>;
  struct Round {
    Place centre{};
    double sweep = 0;  ///< In radians, counter-clockwise; one turn at most.
    double length = 0;
  };

  Place from{};
  Place to{};
  bool clockwise = false;
  double unit = 1;  ///< mm of the unit that it is written in, which says what is rounding.

  /// A message if both ends are not on a circle around it.
  tl::expected<Round, std::string> around(const Place& centre) const;
  /// Below 0: the longer of the two. A message if there is none.
  tl::expected<Round, std::string> of_radius(double radius) const;

 private:
  double radius_slack(double radius) const;
  std::string in_unit(double length) const;
};

}  // namespace tmcl::plan::path_file::gcode

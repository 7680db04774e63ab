/// What is told of a simulated movement, besides its picture.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include <boost/json/array.hpp>
#include <boost/json/object.hpp>

#include "profile/drawing.hpp"

namespace tmclctl::profile {

/// The motion at each of the times, in their order.
Result<boost::json::array> samples_of(const Profile& profile, const std::vector<double>& times);
boost::json::object to_json(const Profile& profile, boost::json::array samples);

/// A row every `step`, in what the chip counts in: time, position, velocity and acceleration, or
/// what is to be shown.
struct Rows {
  double step = 0;
  plot::Shown shown{};
  bool to_the_end = false;  ///< And not to the first row at which it stands.
};
Result<std::string> to_csv(const Profile& profile, const Rows& rows);

/// What was given, in registers.
void print_registers(const Profile& profile, std::ostream& out);
/// How long it takes to come up to speed, and down to rest.
void print_ramps(const Profile& profile, std::ostream& out);
/// Times, peaks and ways of each.
void print_comparison(const std::vector<Profile>& profiles, std::ostream& out);

}  // namespace tmclctl::profile

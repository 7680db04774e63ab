/// What a module knows about itself.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::axis {

struct Errors {
  TMCL_STRUCT(Errors);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::vector<std::string>, flags,
             "what its module says is wrong: stall, deviation, overtemperature, "
             "overtemperature_warning, short_to_ground_a, short_to_ground_b, open_load_a, "
             "open_load_b, undervoltage, overvoltage, i2t_exceeded");
  TMCL_FIELD(std::vector<std::string>, unproven,
             "open_load_a, open_load_b: reported, but not yet twice in a row while the axis turned "
             "slowly");
  TMCL_FIELD(std::vector<std::string>, switches, "those that are closed: left, right, home");
  TMCL_FIELD(std::optional<std::string>, stop_cause, "as in axis.get_state");
  TMCL_FIELD(std::optional<double>, supply_volts, "voltage of the supply; null if it tells none");
  TMCL_FIELD(std::optional<double>, temperature_celsius,
             "temperature of the module; null if it tells none");
};
struct GetErrors {
  TMCL_METHOD("axis.get_errors", reads, Errors, "what its module says is wrong, in words",
              GetErrors);
  TMCL_FIELD(std::string, axis, axis_summary);
};

}  // namespace tmcl::api::axis

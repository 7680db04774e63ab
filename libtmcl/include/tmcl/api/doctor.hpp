/// The method that looks for what keeps axes from moving. See tmcl/doctor.hpp.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::doctor {

struct Finding {
  TMCL_STRUCT(Finding);
  TMCL_FIELD(std::string, check, "its name, such as supply");
  TMCL_FIELD(std::string, subject,
             "the axis, the module (bench:1) or the bus; empty: tmcld itself");
  TMCL_FIELD(bool, wrong, "it keeps axes from moving, or may");
  TMCL_FIELD(std::string, text, "what is so, in a sentence");
  TMCL_FIELD(std::optional<std::string>, cure, "what to do; null where nothing is wrong");
};
struct Findings {
  TMCL_STRUCT(Findings);
  TMCL_FIELD(std::vector<Finding>, findings, "in the order in which to look at them");
};
struct Examine {
  TMCL_METHOD("doctor.examine", reads, Findings,
              "looks for what keeps axes from moving, and says what to do", Examine);
  TMCL_FIELD(std::optional<std::string>, axis, "an axis, with its module and its bus");
  TMCL_FIELD(std::optional<std::string>, bus,
             "a bus, with all that is on it; everything if absent");
};

}  // namespace tmcl::api::doctor

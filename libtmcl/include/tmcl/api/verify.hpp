/// The method that holds a module against its twin: see tmcl/verification.hpp.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::axis {

struct VerifiedTrait {
  TMCL_STRUCT(VerifiedTrait);
  TMCL_FIELD(std::string, trait, "such as last_step: a key of a file for tmclsim --as");
  TMCL_FIELD(std::string, foreseen, "the variant that its twin has");
  TMCL_FIELD(bool, measured, "it was tried what the module does");
  TMCL_FIELD(
      std::vector<std::string>, fits,
      "which variants do; none of those that are known, if it was tried and nothing is here");
  TMCL_FIELD(std::string, text, "what was seen, or why it was not tried");
};
struct VerifiedMove {
  TMCL_STRUCT(VerifiedMove);
  TMCL_FIELD(std::int32_t, distance_microsteps, "how far");
  TMCL_FIELD(std::string, settings, "what the ramp generator was set to");
  TMCL_FIELD(double, foreseen_s, "how long its twin takes");
  TMCL_FIELD(double, least_s, "it took longer than this");
  TMCL_FIELD(double, most_s, "and no longer than this");
};
struct Verified {
  TMCL_STRUCT(Verified);
  TMCL_FIELD(std::string, model, "of the module");
  TMCL_FIELD(std::string, firmware, "its version");
  TMCL_FIELD(std::optional<std::int64_t>, answer_us,
             "how quickly it has answered at best, without what the wire takes; null on CAN");
  TMCL_FIELD(std::vector<VerifiedTrait>, traits, "those that make a difference to its model");
  TMCL_FIELD(std::vector<VerifiedMove>, moves, "those that told variants of its chip apart");
  TMCL_FIELD(std::string, report,
             "all this as a text: the file that tmclsim --as and 'as' in [[module]] take");
};
struct Verify {
  TMCL_METHOD("axis.verify", moves, Verified,
              "moves an axis a little, and finds out in what its module is not like its twin",
              Verify);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(
      std::optional<std::int32_t>, from_microsteps,
      "how far it may go down from where it stands: 0 or less; to its soft limits if absent");
  TMCL_FIELD(std::optional<Amount>, from, in_unit_summary);
  TMCL_FIELD(std::optional<std::int32_t>, to_microsteps,
             "how far it may go up from there: 0 or more");
  TMCL_FIELD(std::optional<Amount>, to, in_unit_summary);
};
struct VerifyProgress {
  TMCL_STRUCT(VerifyProgress);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::string, text, "what is done next");
};

}  // namespace tmcl::api::axis

/// Relays: programs that bring calls of users whom tmcld does not know.
#pragma once

#include <string>

#include "tmcl/api/field.hpp"

namespace tmcl::api::relay {

constexpr std::string_view user_summary = "who makes the calls, as audit and leases name them";
constexpr std::string_view role_summary =
    "what that user may do: stop, observe, operate, configure";

struct Spoken {
  TMCL_STRUCT(Spoken);
  TMCL_FIELD(std::string, user, user_summary);
  TMCL_FIELD(std::string, role, role_summary);
};
struct SpeakFor {
  TMCL_METHOD("speak_for", reads, Spoken,
              "makes the calls of this connection those of a user, from now on", SpeakFor);
  TMCL_FIELD(std::string, user, user_summary);
  TMCL_FIELD(std::string, role, role_summary);
};

}  // namespace tmcl::api::relay

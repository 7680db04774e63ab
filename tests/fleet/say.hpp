/// What the programs of the fleet tell the script that runs them: a JSON object a line, with the
/// time of the computer's monotonic clock.
#pragma once

#include <chrono>
#include <cstdio>

#include <boost/json/object.hpp>

#include "tmcl/clock.hpp"
#include "tmcl/json_text.hpp"

namespace tmclfleet {

inline double seconds_of(tmcl::TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

inline void say(boost::json::object what) {
  what["at"] = seconds_of(tmcl::RealClock().now());
  std::printf("%s\n", tmcl::json_text(what).c_str());
  std::fflush(stdout);
}

}  // namespace tmclfleet

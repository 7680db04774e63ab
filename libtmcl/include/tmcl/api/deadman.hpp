/// The methods about a module's own deadman: it stops its motors when no host has sent it
/// anything for a time.
#pragma once

#include "tmcl/api/axis.hpp"

namespace tmcl::api::axis {

constexpr std::int64_t longest_deadman_ms = 65'535;

/// That of a module which was seen to have stopped a motor.
struct Deadman {
  TMCL_STRUCT(Deadman);
  TMCL_FIELD(std::int32_t, ms, "what the module is set to");
  TMCL_FIELD(std::int32_t, measured, "after so many milliseconds without a command it has stopped");
};

struct DeadmanSetting {
  TMCL_STRUCT(DeadmanSetting);
  TMCL_FIELD(std::int32_t, ms, "what its module is set to now; 0: off");
};
struct SetDeadman {
  TMCL_METHOD("axis.set_deadman", writes, DeadmanSetting,
              "sets the deadman of the module of an axis, in its EEPROM", SetDeadman);
  TMCL_FIELD(std::string, axis, axis_summary);
  TMCL_FIELD(std::int32_t, ms, "it stops its motors after so long; 0: off, or 100 and more",
             {0, longest_deadman_ms});
};

struct TestedDeadman {
  TMCL_STRUCT(TestedDeadman);
  TMCL_FIELD(WordOr<Deadman>, deadman, "none, or what was found");
  TMCL_FIELD(std::optional<std::string>, reason, "why there is none");
  TMCL_FIELD(std::int32_t, way_microsteps, "how far the axis has gone");
};
struct TestDeadman {
  TMCL_METHOD("axis.test_deadman", moves, TestedDeadman,
              "moves an axis slowly, sends its module nothing, and measures when it stops",
              TestDeadman);
  TMCL_FIELD(std::string, axis, axis_summary);
};

}  // namespace tmcl::api::axis

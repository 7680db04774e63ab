/// Whole trajectories on axes of a tmcld, without anything of ROS 2: what trajectory_node.cpp shows
/// to that.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace tmcl::ros2 {

/// In radians or metres; one position for each joint.
struct Waypoint {
  double at_s = 0;
  std::vector<double> positions{};
};

struct Trajectory {
  std::vector<std::string> joints{};
  std::vector<Waypoint> points{};
  /// By joints: how far one may be off its way, in radians or metres; 0 and less say nothing.
  std::map<std::string, double> tolerances{};
};

struct TrajectoryChoices {
  std::string socket = "/run/tmcld/tmcld.sock";
  double lease_ttl_s = 2;                     ///< 1 to 60
  double period_s = 0.005;                    ///< Between two updates; 0.005 to 1.
  std::map<std::string, std::string> axes{};  ///< By joints.
};

struct Failure {
  enum class Kind : std::uint8_t {
    bad_joints,   ///< Nothing has moved.
    refused,      ///< Nothing has moved.
    cancelled,    ///< The axes stand.
    ended_early,  ///< `text` says whether an axis may still move.
    not_at_end,
  };
  Kind kind = Kind::refused;
  std::string text{};  ///< A sentence.
};

/// Has tmcld move the axes along it, under a lease, and returns when they stand at its end. Where
/// it does not begin at 0 s, it begins where the axes stand. `cancelled` is asked ten times a
/// second; true stops them.
tl::expected<void, Failure> carry_out(const Trajectory& trajectory,
                                      const TrajectoryChoices& choices,
                                      const std::function<bool()>& cancelled);

}  // namespace tmcl::ros2

/// Stands in for the action of control_msgs, as far as tools/bridges/ros2 asks for it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace builtin_interfaces::msg {

struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
using Duration = Time;

}  // namespace builtin_interfaces::msg

namespace trajectory_msgs::msg {

struct Header {
  builtin_interfaces::msg::Time stamp;
};
struct JointTrajectoryPoint {
  std::vector<double> positions;
  builtin_interfaces::msg::Duration time_from_start;
};
struct JointTrajectory {
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
};

}  // namespace trajectory_msgs::msg

namespace control_msgs::msg {

struct JointTolerance {
  std::string name;
  double position = 0;
};

}  // namespace control_msgs::msg

namespace control_msgs::action {

struct FollowJointTrajectory {
  struct Goal {
    trajectory_msgs::msg::JointTrajectory trajectory;
    std::vector<control_msgs::msg::JointTolerance> path_tolerance;
  };
  struct Result {
    static constexpr std::int32_t SUCCESSFUL = 0, INVALID_GOAL = -1, INVALID_JOINTS = -2,
                                  OLD_HEADER_TIMESTAMP = -3, PATH_TOLERANCE_VIOLATED = -4,
                                  GOAL_TOLERANCE_VIOLATED = -5;
    std::int32_t error_code = SUCCESSFUL;
    std::string error_string;
  };
};

}  // namespace control_msgs::action

/// An action server whose trajectories tmcld carries out: docs/bridges/ros2.md.

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <control_msgs/action/follow_joint_trajectory.hpp>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <tl/expected.hpp>

#include "trajectory.hpp"

namespace tmcl::ros2 {

using Action = control_msgs::action::FollowJointTrajectory;
using GoalHandle = rclcpp_action::ServerGoalHandle<Action>;

namespace {

double seconds(const auto& time) { return time.sec + 1e-9 * time.nanosec; }

Trajectory trajectory_of(const Action::Goal& goal) {
  Trajectory trajectory;
  trajectory.joints = goal.trajectory.joint_names;
  for (const auto& point : goal.trajectory.points)
    trajectory.points.push_back(
        {.at_s = seconds(point.time_from_start), .positions = point.positions});
  for (const auto& tolerance : goal.path_tolerance)
    trajectory.tolerances[tolerance.name] = tolerance.position;
  return trajectory;
}

/// Of each Failure::Kind.
constexpr std::array error_codes{
    Action::Result::INVALID_JOINTS, Action::Result::INVALID_GOAL, Action::Result::SUCCESSFUL,
    Action::Result::PATH_TOLERANCE_VIOLATED, Action::Result::GOAL_TOLERANCE_VIOLATED};

}  // namespace

class TrajectoryNode : public rclcpp::Node {
 public:
  TrajectoryNode() : Node("tmcl_trajectory") {
    choose();
    server_ = rclcpp_action::create_server<Action>(
        this, declare_parameter("action", std::string("tmcl/follow_joint_trajectory")),
        [this](const rclcpp_action::GoalUUID&, std::shared_ptr<const Action::Goal>) {
          return is_busy_ ? rclcpp_action::GoalResponse::REJECT
                          : rclcpp_action::GoalResponse::ACCEPT_AND_EXECUTE;
        },
        [](std::shared_ptr<GoalHandle>) { return rclcpp_action::CancelResponse::ACCEPT; },
        [this](std::shared_ptr<GoalHandle> goal) {
          is_busy_ = true;
          worker_ = std::jthread([this, goal = std::move(goal)] { follow(*goal); });
        });
  }

 private:
  void choose() {
    const std::vector<std::string> none;
    choices_.socket = declare_parameter("gateway", choices_.socket);
    choices_.lease_ttl_s = declare_parameter("lease_ttl", choices_.lease_ttl_s);
    choices_.period_s = declare_parameter("period", choices_.period_s);
    const auto joints = declare_parameter("joints", none);
    auto axes = declare_parameter("axes", none);
    if (axes.empty()) axes = joints;
    if (!(choices_.lease_ttl_s >= 1 && choices_.lease_ttl_s <= 60))
      throw std::invalid_argument("lease_ttl is 1 to 60 seconds");
    if (!(choices_.period_s >= 0.005 && choices_.period_s <= 1))
      throw std::invalid_argument("period is 0.005 to 1 seconds");
    if (joints.empty() || axes.size() != joints.size())
      throw std::invalid_argument("joints names the joints, and axes the axis of each of them");
    for (std::size_t i = 0; i < joints.size(); ++i) choices_.axes[joints[i]] = axes[i];
  }

  tl::expected<void, Failure> carried_out(const GoalHandle& goal) const {
    const auto& wish = *goal.get_goal();
    if (seconds(wish.trajectory.header.stamp) != 0)
      return tl::unexpected(
          Failure{Failure::Kind::refused, "it begins at once: its header.stamp has to be 0"});
    const auto cancelled = [&] { return goal.is_canceling() || !rclcpp::ok(); };
    return carry_out(trajectory_of(wish), choices_, cancelled);
  }

  void follow(GoalHandle& goal) {
    const auto done = carried_out(goal);
    is_busy_ = false;
    if (!rclcpp::ok()) return;  // There is no client any more to answer to.
    const auto result = std::make_shared<Action::Result>();
    if (done) return goal.succeed(result);
    result->error_code = error_codes.at(static_cast<std::size_t>(done.error().kind));
    result->error_string = done.error().text;
    RCLCPP_ERROR(get_logger(), "tmcl: %s", result->error_string.c_str());
    if (done.error().kind == Failure::Kind::cancelled) return goal.canceled(result);
    goal.abort(result);
  }

  TrajectoryChoices choices_;
  std::atomic<bool> is_busy_ = false;
  rclcpp_action::Server<Action>::SharedPtr server_;
  std::jthread worker_;  ///< Ends first.
};

}  // namespace tmcl::ros2

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  try {
    rclcpp::spin(std::make_shared<tmcl::ros2::TrajectoryNode>());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tmcl_trajectory: %s\n", error.what());
    return 1;
  }
  rclcpp::shutdown();
}

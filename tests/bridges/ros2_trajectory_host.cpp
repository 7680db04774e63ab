// What ROS 2 is to tmcl_trajectory: its parameters, and the client of its action. Parameters are
// given as NAME=VALUE, lists of texts with commas. Standard input has a line for each request, and
// its end ends the node:
//
//     goal STAMP JOINTS TOLERANCES POINTS    such as: goal 0 slide,turn - 0.5:0.001,0.2;1:0.002,0.1
//     cancel
//
// Each is answered by a line: accepted, rejected or cancelling. The end of a goal is one, too:
// succeeded, aborted or canceled, with the error code and the text.

#include <atomic>
#include <cmath>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>

#include "control_msgs/action/follow_joint_trajectory.hpp"
#include "rclcpp/rclcpp.hpp"
#include "rclcpp_action/rclcpp_action.hpp"

namespace {

using FollowAction = control_msgs::action::FollowJointTrajectory;
using FollowServer = rclcpp_action::Server<FollowAction>;
using FollowHandle = rclcpp_action::ServerGoalHandle<FollowAction>;

std::map<std::string, std::string> parameters_given;
std::atomic<bool> is_ok = true;

void say(const std::string& line) {
  static std::mutex saying;
  const std::scoped_lock alone(saying);
  std::cout << line << std::endl;
}

std::vector<std::string> parts_of(const std::string& text, char mark) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, mark);)
    if (part != "-") parts.push_back(part);
  return parts;
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  for (const auto& part : parts_of(text, ',')) numbers.push_back(std::stod(part));
  return numbers;
}

trajectory_msgs::msg::JointTrajectoryPoint point_of(const std::string& text) {
  const auto parts = parts_of(text, ':');
  const auto nanoseconds = std::llround(std::stod(parts[0]) * 1e9);
  trajectory_msgs::msg::JointTrajectoryPoint point;
  point.time_from_start.sec = static_cast<std::int32_t>(nanoseconds / 1'000'000'000);
  point.time_from_start.nanosec = static_cast<std::uint32_t>(nanoseconds % 1'000'000'000);
  if (parts.size() > 1) point.positions = numbers_of(parts[1]);
  return point;
}

std::shared_ptr<FollowAction::Goal> goal_in(std::istream& words) {
  std::string joints, tolerances, points;
  auto goal = std::make_shared<FollowAction::Goal>();
  words >> goal->trajectory.header.stamp.sec >> joints >> tolerances >> points;
  goal->trajectory.joint_names = parts_of(joints, ',');
  for (const auto& tolerance : parts_of(tolerances, ',')) {
    const auto parts = parts_of(tolerance, '=');
    goal->path_tolerance.push_back({.name = parts[0], .position = std::stod(parts[1])});
  }
  for (const auto& point : parts_of(points, ';'))
    goal->trajectory.points.push_back(point_of(point));
  return goal;
}

std::shared_ptr<FollowHandle> offer(const std::shared_ptr<FollowAction::Goal>& goal) {
  const auto server = FollowServer::only.lock();
  if (server->handle_goal({}, goal) == rclcpp_action::GoalResponse::REJECT) return nullptr;
  return std::make_shared<FollowHandle>(
      goal, [](const std::string& end, const FollowAction::Result& result) {
        say(end + ' ' + std::to_string(result.error_code) + ' ' + result.error_string);
      });
}

}  // namespace

namespace rclcpp {

std::string Node::declare_parameter(const std::string& name, const std::string& usual) {
  return parameters_given.contains(name) ? parameters_given.at(name) : usual;
}

double Node::declare_parameter(const std::string& name, double usual) {
  return parameters_given.contains(name) ? std::stod(parameters_given.at(name)) : usual;
}

std::vector<std::string> Node::declare_parameter(const std::string& name,
                                                 const std::vector<std::string>& usual) {
  return parameters_given.contains(name) ? parts_of(parameters_given.at(name), ',') : usual;
}

void init(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string text = argv[i];
    parameters_given[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
}

void spin(const std::shared_ptr<Node>& /*node*/) {
  std::shared_ptr<FollowHandle> running;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream words(line);
    std::string verb;
    words >> verb;
    if (verb == "cancel") {
      FollowServer::only.lock()->handle_cancel(running);
      running->cancel();
      say("cancelling");
    } else if (const auto handle = offer(goal_in(words))) {
      running = handle;
      say("accepted");
      FollowServer::only.lock()->handle_accepted(handle);
    } else {
      say("rejected");
    }
  }
  shutdown();
}

bool ok() { return is_ok; }
bool shutdown() { return is_ok.exchange(false); }

}  // namespace rclcpp

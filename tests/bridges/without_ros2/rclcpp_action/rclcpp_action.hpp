/// Stands in for rclcpp_action of ROS 2 Jazzy, with its names and its signatures, as far as
/// tools/bridges/ros2 asks for it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace rclcpp_action {

using GoalUUID = std::array<std::uint8_t, 16>;
enum class GoalResponse : std::int8_t { REJECT = 1, ACCEPT_AND_EXECUTE = 2, ACCEPT_AND_DEFER = 3 };
enum class CancelResponse : std::int8_t { REJECT = 1, ACCEPT = 2 };

/// As there, a goal has one end, and is canceled only where that was asked for.
template <class Action>
class ServerGoalHandle {
 public:
  using Goal = std::shared_ptr<const typename Action::Goal>;
  using Result = std::shared_ptr<typename Action::Result>;
  using OnEnd = std::function<void(const std::string& end, const typename Action::Result&)>;

  ServerGoalHandle(Goal goal, OnEnd on_end) : goal_(std::move(goal)), on_end_(std::move(on_end)) {}
  Goal get_goal() const { return goal_; }
  bool is_canceling() const { return is_canceling_; }
  void succeed(const Result& result) { end("succeeded", *result); }
  void abort(const Result& result) { end("aborted", *result); }
  void canceled(const Result& result) {
    if (!is_canceling_) std::abort();
    end("canceled", *result);
  }

  void cancel() { is_canceling_ = true; }

 private:
  void end(const std::string& how, const typename Action::Result& result) {
    if (has_ended_.exchange(true)) std::abort();
    on_end_(how, result);
  }

  Goal goal_;
  OnEnd on_end_;
  std::atomic<bool> is_canceling_ = false, has_ended_ = false;
};

template <class Action>
struct Server {
  using SharedPtr = std::shared_ptr<Server>;
  using Handle = std::shared_ptr<ServerGoalHandle<Action>>;

  std::function<GoalResponse(const GoalUUID&, std::shared_ptr<const typename Action::Goal>)>
      handle_goal;
  std::function<CancelResponse(Handle)> handle_cancel;
  std::function<void(Handle)> handle_accepted;

  /// The one of the program.
  static inline std::weak_ptr<Server> only;
};

template <class Action, class Node, class OnGoal, class OnCancel, class OnAccepted>
std::shared_ptr<Server<Action>> create_server(Node /*node*/, const std::string& /*name*/,
                                              OnGoal on_goal, OnCancel on_cancel,
                                              OnAccepted on_accepted) {
  auto server = std::make_shared<Server<Action>>();
  server->handle_goal = on_goal;
  server->handle_cancel = on_cancel;
  server->handle_accepted = on_accepted;
  Server<Action>::only = server;
  return server;
}

}  // namespace rclcpp_action

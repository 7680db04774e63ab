/// Stands in for rclcpp, as far as tools/bridges/ros2 asks for it.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace rclcpp {

class Time {};
class Duration {};
class Logger {};

/// Its parameters are what init() was given.
class Node {
 public:
  explicit Node(const std::string& /*name*/) {}
  std::string declare_parameter(const std::string& name, const std::string& usual);
  double declare_parameter(const std::string& name, double usual);
  std::vector<std::string> declare_parameter(const std::string& name,
                                             const std::vector<std::string>& usual);
  Logger get_logger() const { return {}; }
};

/// Those of the program's host.
void init(int argc, char** argv);
void spin(const std::shared_ptr<Node>& node);
bool ok();
bool shutdown();

}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) \
  (static_cast<void>(logger), std::fprintf(stderr, __VA_ARGS__), std::fprintf(stderr, "\n"))

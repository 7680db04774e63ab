/// Stands in for rclcpp, as far as tools/bridges/ros2 asks for it.
#pragma once

#include <cstdio>

namespace rclcpp {

class Time {};
class Duration {};
class Logger {};

}  // namespace rclcpp

#define RCLCPP_ERROR(logger, ...) \
  (static_cast<void>(logger), std::fprintf(stderr, __VA_ARGS__), std::fprintf(stderr, "\n"))

/// Stands in for ros2_control of ROS 2 Jazzy (hardware_interface 4.46): what a system is made of,
/// with its names and its signatures, as far as tools/bridges/ros2 asks for it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "rclcpp/rclcpp.hpp"

namespace rclcpp_lifecycle {

class State {};

namespace node_interfaces {

class LifecycleNodeInterface {
 public:
  enum class CallbackReturn : std::uint8_t { SUCCESS = 97, FAILURE = 98, ERROR = 99 };

  virtual ~LifecycleNodeInterface() = default;
  virtual CallbackReturn on_configure(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_cleanup(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_shutdown(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_activate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_deactivate(const State&) { return CallbackReturn::SUCCESS; }
  virtual CallbackReturn on_error(const State&) { return CallbackReturn::FAILURE; }
};

}  // namespace node_interfaces
}  // namespace rclcpp_lifecycle

namespace hardware_interface {

using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
enum class return_type : std::uint8_t { OK = 0, ERROR = 1, DEACTIVATE = 2 };

struct InterfaceInfo {
  std::string name;
};

struct ComponentInfo {
  std::string name;
  std::vector<InterfaceInfo> command_interfaces;
  std::vector<InterfaceInfo> state_interfaces;
  std::unordered_map<std::string, std::string> parameters;
};

struct HardwareInfo {
  std::string name;
  std::unordered_map<std::string, std::string> hardware_parameters;
  std::vector<ComponentInfo> joints;
};

struct HardwareComponentInterfaceParams {
  HardwareInfo hardware_info;
};

class HardwareComponentInterface
    : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
 public:
  virtual CallbackReturn on_init(const HardwareComponentInterfaceParams& params) {
    info_ = params.hardware_info;
    return CallbackReturn::SUCCESS;
  }
  virtual return_type read(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;
  virtual return_type write(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

  /// In ROS 2 the framework makes these between on_init and on_configure.
  void export_interfaces() {
    for (const auto& joint : info_.joints) {
      for (const auto& state : joint.state_interfaces) states_[joint.name + "/" + state.name] = 0;
      for (const auto& said : joint.command_interfaces) commands_[joint.name + "/" + said.name] = 0;
    }
  }

  const HardwareInfo& get_hardware_info() const { return info_; }
  virtual rclcpp::Logger get_logger() const { return {}; }
  virtual bool has_state(const std::string& name) const { return states_.contains(name); }
  template <typename T>
  void set_state(const std::string& name, const T& value) {
    states_.at(name) = value;
  }
  template <typename T = double>
  T get_state(const std::string& name) const {
    return states_.at(name);
  }
  template <typename T>
  void set_command(const std::string& name, const T& value) {
    commands_.at(name) = value;
  }
  template <typename T = double>
  T get_command(const std::string& name) const {
    return commands_.at(name);
  }

 private:
  HardwareInfo info_;
  std::map<std::string, double> states_;
  std::map<std::string, double> commands_;
};

class SystemInterface : public HardwareComponentInterface {};

}  // namespace hardware_interface

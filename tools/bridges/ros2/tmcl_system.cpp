/// Axes of a tmcld as joints of ros2_control: docs/bridges/ros2.md.

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <hardware_interface/system_interface.hpp>
#include <pluginlib/class_list_macros.hpp>
#include <rclcpp/rclcpp.hpp>
#include <tl/expected.hpp>

#include "joints.hpp"

namespace tmcl::ros2 {

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;

namespace {

std::string text_in(const auto& parameters, const std::string& name, const std::string& usual) {
  return parameters.contains(name) ? parameters.at(name) : usual;
}

tl::expected<Choices, std::string> choices_of(const hardware_interface::HardwareInfo& info) {
  Choices choices;
  choices.socket = text_in(info.hardware_parameters, "gateway", choices.socket);
  choices.lease_ttl_s = std::atof(text_in(info.hardware_parameters, "lease_ttl", "2").c_str());
  if (!(choices.lease_ttl_s >= 1 && choices.lease_ttl_s <= 60))
    return tl::unexpected(std::string("lease_ttl is 1 to 60 seconds"));
  for (const auto& joint : info.joints) {
    const auto& commands = joint.command_interfaces;
    if (commands.size() != 1 || commands.front().name != "position")
      return tl::unexpected("joint '" + joint.name + "' is to have one command, position");
    choices.axes.push_back(text_in(joint.parameters, "axis", joint.name));
  }
  return choices;
}

}  // namespace

class TmclSystem : public hardware_interface::SystemInterface {
 public:
  CallbackReturn on_init(
      const hardware_interface::HardwareComponentInterfaceParams& params) override {
    auto choices = choices_of(params.hardware_info);
    if (!choices) return complain(choices.error(), CallbackReturn::ERROR);
    choices_ = std::move(*choices);
    return SystemInterface::on_init(params);
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    joints_ = std::make_unique<Joints>(choices_);
    const auto open = joints_->open();
    return open ? CallbackReturn::SUCCESS : complain(open.error(), CallbackReturn::FAILURE);
  }

  /// The first command is where each axis stands.
  CallbackReturn on_activate(const rclcpp_lifecycle::State&) override {
    const auto stands = joints_->take();
    if (!stands) {
      static_cast<void>(joints_->give());
      return complain(stands.error(), CallbackReturn::FAILURE);
    }
    commands_ = *stands;
    for (std::size_t i = 0; i < commands_.size(); ++i)
      set_command(interface_of(i, "position"), commands_[i]);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override {
    const auto given = joints_->give();
    return given ? CallbackReturn::SUCCESS : complain(given.error(), CallbackReturn::ERROR);
  }
  CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) override { return close(); }
  CallbackReturn on_shutdown(const rclcpp_lifecycle::State&) override { return close(); }
  CallbackReturn on_error(const rclcpp_lifecycle::State&) override { return close(); }

  return_type read(const rclcpp::Time&, const rclcpp::Duration&) override {
    const auto readings = joints_->read();
    if (!readings) return complain(readings.error(), return_type::ERROR);
    for (std::size_t i = 0; i < readings->size(); ++i) show(i, (*readings)[i]);
    return return_type::OK;
  }

  return_type write(const rclcpp::Time&, const rclcpp::Duration&) override {
    for (std::size_t i = 0; i < commands_.size(); ++i)
      commands_[i] = get_command<double>(interface_of(i, "position"));
    const auto taken = joints_->command(commands_);
    return taken ? return_type::OK : complain(taken.error(), return_type::ERROR);
  }

 private:
  std::string interface_of(std::size_t joint, const std::string& name) const {
    return get_hardware_info().joints[joint].name + "/" + name;
  }

  void show(std::size_t joint, const Reading& reading) {
    const auto set = [&](const std::string& name, double value) {
      if (has_state(interface_of(joint, name))) set_state(interface_of(joint, name), value);
    };
    set("position", reading.position);
    set("velocity", reading.velocity);
    set("age", reading.age_s);
  }

  /// tmcld stops what was moved, and no old value is left.
  CallbackReturn close() {
    joints_.reset();
    for (std::size_t i = 0; i < choices_.axes.size(); ++i) show(i, {});
    return CallbackReturn::SUCCESS;
  }

  template <class Result>
  Result complain(const std::string& why, Result result) const {
    RCLCPP_ERROR(get_logger(), "tmcl: %s", why.c_str());
    return result;
  }

  Choices choices_;
  std::unique_ptr<Joints> joints_;
  std::vector<double> commands_;
};

}  // namespace tmcl::ros2

PLUGINLIB_EXPORT_CLASS(tmcl::ros2::TmclSystem, hardware_interface::SystemInterface)

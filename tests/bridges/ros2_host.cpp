// The life of a system in ros2_control, with a stand-in of its classes: reads and writes fifty
// times a second, as its controller manager does, and does what lines of standard input say.
//
//     ros2_host SOCKET AXIS...
//     configure, activate, deactivate, cleanup     a transition
//     command JOINT VALUE                          what a controller writes into the interface
//     show
//
// Each answers with the state after it, then position, velocity and age of each joint.

#include <array>
#include <iostream>
#include <sstream>
#include <string>

#include <poll.h>
#include <unistd.h>

#include "hardware_interface/system_interface.hpp"
#include "pluginlib/class_list_macros.hpp"

namespace {

using hardware_interface::CallbackReturn;
using hardware_interface::return_type;

constexpr int period_ms = 20;

enum class LifeState { unconfigured, inactive, active, finalized };
constexpr std::array life_state_names{"unconfigured", "inactive", "active", "finalized"};

class HostedSystem {
 public:
  explicit HostedSystem(const hardware_interface::HardwareInfo& info) {
    if (system_->on_init({info}) != CallbackReturn::SUCCESS) state_ = LifeState::finalized;
    system_->export_interfaces();
  }

  void cycle() {
    if (state_ != LifeState::inactive && state_ != LifeState::active) return;
    if (system_->read({}, {}) == return_type::ERROR) return error();
    if (state_ == LifeState::active && system_->write({}, {}) == return_type::ERROR) error();
  }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string verb, joint, value;
    words >> verb >> joint >> value;
    using System = hardware_interface::SystemInterface;
    if (verb == "configure")
      go(LifeState::unconfigured, &System::on_configure, LifeState::inactive);
    if (verb == "activate") go(LifeState::inactive, &System::on_activate, LifeState::active);
    if (verb == "deactivate") go(LifeState::active, &System::on_deactivate, LifeState::inactive);
    if (verb == "cleanup") go(LifeState::inactive, &System::on_cleanup, LifeState::unconfigured);
    if (verb == "command") system_->set_command(joint + "/position", std::stod(value));
    show();
  }

 private:
  using Transition =
      CallbackReturn (hardware_interface::SystemInterface::*)(const rclcpp_lifecycle::State&);
  void go(LifeState from, Transition transition, LifeState to) {
    if (state_ != from) return;
    const auto said = ((*system_).*transition)({});
    if (said == CallbackReturn::ERROR) return error();
    if (said == CallbackReturn::SUCCESS) state_ = to;
  }

  void error() {
    const bool is_over = system_->on_error({}) == CallbackReturn::SUCCESS;
    state_ = is_over ? LifeState::unconfigured : LifeState::finalized;
  }

  void show() {
    std::cout << life_state_names[static_cast<std::size_t>(state_)];
    for (const auto& joint : system_->get_hardware_info().joints)
      for (const auto* name : {"/position", "/velocity", "/age"})
        std::cout << ' ' << system_->get_state(joint.name + name);
    std::cout << std::endl;
  }

  std::unique_ptr<hardware_interface::SystemInterface> system_ = make_plugin();
  LifeState state_ = LifeState::unconfigured;
};

hardware_interface::HardwareInfo described_by(int argc, char** argv) {
  hardware_interface::HardwareInfo info;
  info.hardware_parameters["gateway"] = argv[1];
  for (int i = 2; i < argc; ++i) {
    const std::string axis = argv[i];
    info.joints.push_back({.name = "joint_" + axis,
                           .command_interfaces = {{"position"}},
                           .state_interfaces = {{"position"}, {"velocity"}, {"age"}},
                           .parameters = {{"axis", axis}}});
  }
  return info;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  HostedSystem hosted(described_by(argc, argv));
  std::cout.precision(12);
  std::string line;
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  while (true) {
    hosted.cycle();
    if (poll(&input, 1, period_ms) <= 0) continue;
    std::array<char, 256> text{};
    const auto got = read(STDIN_FILENO, text.data(), text.size());
    if (got <= 0) return 0;
    line.append(text.data(), static_cast<std::size_t>(got));
    for (auto end = line.find('\n'); end != std::string::npos; end = line.find('\n')) {
      hosted.obey(line.substr(0, end));
      line.erase(0, end + 1);
    }
  }
}

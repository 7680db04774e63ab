/// A simulated module that is a USB device of this computer.
#pragma once

#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "support/program.hpp"

namespace tmcl::test {

/// The kernel takes half a second to make a terminal of a device.
template <typename Condition>
bool comes_true(const Condition& condition) {
  using namespace std::chrono_literals;
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(20ms);
  return condition();
}

inline std::filesystem::path usb_device_at(const std::string& place) {
  return std::filesystem::path("/sys/bus/usb/devices") / place;
}

/// What cdc_acm calls it; empty if there is none. Its name comes some milliseconds before its node.
inline std::string terminal_at(const std::string& place) {
  std::error_code none;
  const auto folder = usb_device_at(place) / (place + ":1.0") / "tty";
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (const auto node = "/dev/" + entry.path().filename().string(); std::filesystem::exists(node))
      return node;
  return {};
}

/// Besides the hubs that computers have inside.
inline bool nothing_is_plugged_in() {
  for (const auto& entry : std::filesystem::directory_iterator("/sys/bus/usb/devices")) {
    const auto name = entry.path().filename().string();
    const bool is_hub = name.starts_with("usb");
    const bool is_interface = name.find(':') != std::string::npos;
    if (!is_hub && !is_interface) return false;
  }
  return true;
}

class PluggedIn {
 protected:
  /// The next test finds its place as this one did.
  ~PluggedIn() {
    sim.reset();
    EXPECT_TRUE(comes_true(nothing_is_plugged_in));
  }
  void plug_in(std::vector<std::string> words) {
    plug_in_for_somebody(std::move(words));
    ASSERT_TRUE(comes_true([&] { return !terminal().empty(); })) << sim->output();
  }
  /// Who takes it before the kernel has made a terminal of it.
  void plug_in_for_somebody(std::vector<std::string> words) {
    words.insert(words.begin(), "tmclsim");
    sim = std::make_unique<Program>(words);
    ASSERT_TRUE(sim->wait_for("\nready\n")) << sim->output();
    const auto line = sim->output().find("\nusb ") + 5;
    place = sim->output().substr(line, sim->output().find(',', line) - line);
  }
  void pull_out() {
    sim->signal(SIGKILL);
    ASSERT_TRUE(comes_true([&] { return !std::filesystem::exists(device()); }));
  }
  std::filesystem::path device() const { return usb_device_at(place); }
  std::string terminal() const { return terminal_at(place); }
  /// The emulated computer may keep the simulator waiting; a movement is never sent twice.
  static auto tmclctl(const std::string& link, std::vector<std::string> words) {
    words.insert(words.begin(), {"tmclctl", "--direct", link, "--reply-timeout", "5000"});
    return run_program(words);
  }
  auto tmclctl(std::vector<std::string> words) const {
    return tmclctl("serial:" + terminal(), std::move(words));
  }

  std::unique_ptr<Program> sim;
  std::string place;
};

}  // namespace tmcl::test

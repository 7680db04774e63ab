// tmclsim --usb with the kernel's own drivers: tests/vm/run brings a kernel that has them.

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "sim/wire/usb_layout.hpp"
#include "usb/plugged_in.hpp"

namespace tmcl {
namespace {

namespace fs = std::filesystem;
using test::comes_true;
using testing::HasSubstr;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Usb : public testing::TestWithParam<const char*>, protected test::PluggedIn {};

TEST_P(Usb, IsATerminalOfTheKernels) {
  plug_in({"--module", "TMCM-3110@7", "--usb", GetParam()});
  const auto layout =
      GetParam() == std::string("mk20") ? sim::UsbLayout::mk20 : sim::UsbLayout::gd32;
  const auto& own = sim::descriptors_of(layout);
  std::string expected(own.device.begin(), own.device.end());
  expected.append(own.configuration.begin(), own.configuration.end());
  EXPECT_EQ(text_of(device() / "descriptors"), expected);
  EXPECT_EQ(text_of(device() / "product"), std::string(own.strings[1]) + "\n");
  EXPECT_EQ(text_of(device() / "speed"), "12\n");
  const auto moved = tmclctl({"move", "7/0", "1000microsteps", "--wait"});
  EXPECT_EQ(moved.status, 0) << moved.output;
  const auto position = tmclctl({"get", "7/0", "actual_position"});
  EXPECT_THAT(position.output, HasSubstr("1000"));
}

INSTANTIATE_TEST_SUITE_P(Layouts, Usb, testing::Values("gd32", "mk20"));

class UsbCable : public Usb {};

TEST_F(UsbCable, IsPulledWhenTheSimulatorGoes) {
  plug_in({"--module", "TMCM-1110", "--module", "TMCM-3110@7", "--usb", "7"});
  pull_out();
  plug_in({"--module", "TMCM-1110", "--usb"});
  EXPECT_EQ(tmclctl({"get", "1/0", "max_velocity"}).status, 0);
}

/// As somebody does who starts the simulator again. The kernel takes longer to see two cables
/// pulled.
TEST_F(UsbCable, IsPluggedInAgainAtOnce) {
  for (int i = 0; i < 5; ++i) {
    plug_in({"--module", "TMCM-1110", "--module", "TMCM-3110@7", "--usb", "1", "--usb", "7=mk20"});
    sim->signal(SIGKILL);
    sim->wait();
    plug_in({"--module", "TMCM-1110", "--usb"});
    const auto answer = tmclctl({"get", "1/0", "max_velocity"});
    EXPECT_EQ(answer.status, 0) << answer.output;
    pull_out();
  }
}

TEST_F(UsbCable, FindsASocketForEachOfTwoModules) {
  plug_in({"--module", "TMCM-1110", "--module", "TMCM-3110@7", "--usb", "1", "--usb", "7=mk20"});
  const auto of_both = [] {
    std::vector<std::string> terminals;
    for (const auto& entry : fs::directory_iterator("/sys/class/tty"))
      if (entry.path().filename().string().starts_with("ttyACM"))
        terminals.push_back(entry.path().filename());
    return terminals.size() == 2;
  };
  EXPECT_TRUE(comes_true(of_both));
}

}  // namespace
}  // namespace tmcl

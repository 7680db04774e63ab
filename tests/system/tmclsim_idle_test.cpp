// What a simulator costs that is asked nothing: nothing, whatever its motors do.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "support/program.hpp"
#include "tmcl/blocking.hpp"

namespace tmcl::test {
namespace {

namespace fs = std::filesystem;

struct Usage {
  long processor_ticks = 0;
  long voluntary_switches = 0;
};

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

// utime and stime are the fields 14 and 15 of proc(5)'s stat; the second field may contain anything
// up to its ')'.
Usage usage_of(pid_t process) {
  const auto folder = fs::path("/proc") / std::to_string(process);
  Usage usage;
  const auto stat = text_of(folder / "stat");
  std::istringstream fields(stat.substr(stat.rfind(')') + 1));
  std::string field;
  for (int number = 3; number <= 15 && fields >> field; ++number) {
    if (number >= 14) usage.processor_ticks += std::stol(field);
  }
  for (const auto& thread : fs::directory_iterator(folder / "task")) {
    const auto status = text_of(thread.path() / "status");
    const std::string key = "\nvoluntary_ctxt_switches:";
    usage.voluntary_switches += std::stol(status.substr(status.find(key) + key.size()));
  }
  return usage;
}

TEST(TmclsimIdle, MotorsThatMoveCostNothingWhileNobodyAsks) {
  std::string folder = fs::temp_directory_path() / "tmclsim-XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  Program simulator({"tmclsim", "--module", "TMCM-6110", "--module", "TMCM-142", "--module",
                     "TMCM-6212", "--pty", folder + "/bus", "--tcp", "127.0.0.1:0"});
  ASSERT_TRUE(simulator.wait_for("ready"));
  auto bus = blocking::Bus::open("serial:" + folder + "/bus@115200");
  ASSERT_TRUE(bus);
  const auto axis = [&](std::uint16_t module, std::uint8_t motor) {
    return bus->module(ModuleAddress{module}).axis(motor);
  };
  const std::array movers{axis(1, 0), axis(2, 0), axis(3, 0)};
  for (auto mover : movers) ASSERT_TRUE(mover.move_to({8'000'000}));
  ASSERT_TRUE(axis(1, 5).rotate({1000}));
  ASSERT_TRUE(axis(3, 5).rotate({30'000}));

  const auto before = usage_of(simulator.process());
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const auto after = usage_of(simulator.process());
  EXPECT_LE(after.processor_ticks - before.processor_ticks, 1);
  EXPECT_LE(after.voluntary_switches - before.voluntary_switches, 2);

  for (auto mover : movers) {
    const auto state = mover.state();
    ASSERT_TRUE(state);
    EXPECT_FALSE(state->position_reached);
    EXPECT_GT(state->position.value, 20'000);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace tmcl::test

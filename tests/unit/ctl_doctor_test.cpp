// doctor: what the computer says of a port, and what is shown.
#include <filesystem>
#include <fstream>

#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "connection/port_checks.hpp"
#include "sim/module/module.hpp"
#include "support/other_user.hpp"
#include "tmcl/pty.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl::test {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tmcl::Check;

/// A computer with the files of one.
class PortsOfAComputer : public testing::Test {
 protected:
  PortsOfAComputer() {
    fs::remove_all(root);
    write("dev/ttyUSB0", "");
  }
  ~PortsOfAComputer() override { fs::remove_all(root); }

  void write(const std::string& path, const std::string& text) const {
    fs::create_directories((root / path).parent_path());
    std::ofstream(root / path) << text;
  }
  std::vector<std::string> wrong(const std::string& device = "/dev/ttyUSB0") const {
    std::vector<std::string> names;
    for (const auto& finding : look_at_port(device, "tmcld", root))
      if (finding.wrong) names.emplace_back(info_of(finding.check).name);
    return names;
  }

  const fs::path root = fs::path(testing::TempDir()) / ("computer_" + std::to_string(::getpid()));
};

TEST_F(PortsOfAComputer, AreFineWhereNothingIsWrong) { EXPECT_THAT(wrong(), IsEmpty()); }

TEST_F(PortsOfAComputer, ThatAreNotThere) {
  EXPECT_THAT(wrong("/dev/ttyUSB1"), ElementsAre("port"));
  fs::create_symlink("ttyUSB1", root / "dev/stage");
  EXPECT_THAT(wrong("/dev/stage"), ElementsAre("port"));
}

TEST_F(PortsOfAComputer, ThatHoldBytesBack) {
  write("sys/class/tty/ttyUSB0/device/latency_timer", "16\n");
  EXPECT_THAT(wrong(), ElementsAre("latency"));
  fs::create_symlink("ttyUSB0", root / "dev/stage");
  EXPECT_THAT(wrong("/dev/stage"), ElementsAre("latency"));
  write("sys/class/tty/ttyUSB0/device/latency_timer", "1\n");
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST_F(PortsOfAComputer, ThatThisUserMayNotOpen) {
  fs::permissions(root / "dev/ttyUSB0", fs::perms::none);
  EXPECT_EQ(
      tmcl::test::told_by_other_user([&] { return fmt::format("{}", fmt::join(wrong(), " ")); }),
      "access");
}

// What is no character device has no entry of udev, and is no port that it would try.
TEST_F(PortsOfAComputer, AreNotTriedByAModemManagerWhereTheyAreNone) {
  write("proc/17/comm", "ModemManager\n");
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST(PortsOfThisProgram, AreFreeOfOthers) {
  const auto pty = tmcl::open_pty().value();
  for (const auto& finding : look_at_port(pty.slave_name, "unit_tests")) {
    if (finding.check != Check::holder) continue;
    EXPECT_FALSE(finding.wrong);
    EXPECT_EQ(finding.text, "it is: only this program has it");
    return;
  }
  FAIL() << "no finding on its holder";
}

// ---- what is shown -----------------------------------------------------------------------------

/// On a link of which the computer knows nothing.
class CtlDoctor : public testing::Test, public CtlBench {
 protected:
  CtlDoctor()
      : CtlBench("[[bus]]\nname = \"bench\"\nlink = \"tcp:127.0.0.1:4001\"\n" +
                 axis_section("x", 1)) {}
};

TEST_F(CtlDoctor, ShowsTheFirstThingThatIsWrong) {
  module().set_supply(0);
  set("max_current", 0);
  EXPECT_EQ(run({"doctor"}), ExitCode::refused);
  EXPECT_EQ(out,
            "x: supply: its supply is too low: 0.0 V\n"
            "  look at the pins of the motor's supply: many modules take logic and motors on two\n"
            "1 more is wrong: --all shows it\n");
}

TEST_F(CtlDoctor, ShowsAllQuestionsAndAnswers) {
  module().set_supply(0);
  EXPECT_EQ(run({"doctor", "--all"}), ExitCode::refused);
  EXPECT_THAT(out, ContainsRegex("       bench +is the bus open\\?"));
  EXPECT_THAT(out, ContainsRegex("WRONG  x +does the motor have its supply\\?"));
  EXPECT_THAT(out, HasSubstr("\nx: supply: its supply is too low: 0.0 V\n  look at the pins"));
}

TEST_F(CtlDoctor, IsDoneWhereNothingIsWrong) {
  EXPECT_EQ(run({"doctor", "x"}), ExitCode::done) << out;
  EXPECT_THAT(out, ContainsRegex("nothing is wrong, as far as [0-9]+ checks tell"));
  EXPECT_EQ(calls.back(), R"(doctor.examine {"axis":"x"})");
}

TEST_F(CtlDoctor, AsksForEachAxisOfAModule) {
  ASSERT_EQ(run({"doctor", "1"}), ExitCode::done) << err << out;
  EXPECT_EQ(calls.back(), R"(doctor.examine {"axis":"x"})");
  add("TMCM-1110", 7);
  EXPECT_EQ(run({"doctor", "7"}), ExitCode::done) << err << out;
  EXPECT_EQ(calls.back(), R"(doctor.examine {"axis":"bench:7/0"})");
}

}  // namespace
}  // namespace tmclctl::test

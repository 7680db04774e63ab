// doctor: what the computer says of a port, and what is shown.
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "connection/port_checks.hpp"
#include "ctl_fixture.hpp"
#include "tmcl/pty.hpp"

namespace tmclctl::test {
namespace {

namespace fs = std::filesystem;
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
  if (::geteuid() == 0) GTEST_SKIP() << "root may open everything";
  fs::permissions(root / "dev/ttyUSB0", fs::perms::none);
  EXPECT_THAT(wrong(), ElementsAre("access"));
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

class CtlDoctor : public testing::Test, public Ctl {
 protected:
  static boost::json::object finding(const char* check, const char* subject, bool wrong) {
    boost::json::object one{{"check", check},
                            {"subject", subject},
                            {"wrong", wrong},
                            {"text", std::string("it is ") + check}};
    one["cure"] = wrong ? boost::json::value("mend it") : boost::json::value(nullptr);
    return one;
  }
  void find(boost::json::array findings) {
    target.results.push_back({{"buses", boost::json::array{}}});
    target.result = {{"findings", std::move(findings)}};
  }
};

TEST_F(CtlDoctor, ShowsTheFirstThingThatIsWrong) {
  find({finding("switches", "y", true), finding("bus", "b", false), finding("supply", "x", true)});
  EXPECT_EQ(run({"doctor"}), ExitCode::refused);
  EXPECT_EQ(out, "x: supply: it is supply\n  mend it\n1 more is wrong: --all shows it\n");
}

TEST_F(CtlDoctor, ShowsAllQuestionsAndAnswers) {
  find({finding("bus", "b", false), finding("supply", "x", true)});
  EXPECT_EQ(run({"doctor", "--all"}), ExitCode::refused);
  EXPECT_THAT(out, HasSubstr("       b   is the bus open?"));
  EXPECT_THAT(out, HasSubstr("WRONG  x   does the motor have its supply?"));
  EXPECT_THAT(out, HasSubstr("\nx: supply: it is supply\n  mend it\n"));
}

TEST_F(CtlDoctor, IsDoneWhereNothingIsWrong) {
  find({finding("bus", "b", false)});
  EXPECT_EQ(run({"doctor", "x"}), ExitCode::done);
  EXPECT_THAT(out, HasSubstr("nothing is wrong, as far as 2 checks tell"));
  EXPECT_THAT(target.calls.back(), HasSubstr(R"(doctor.examine {"axis":"x"})"));
}

TEST_F(CtlDoctor, AsksForEachAxisOfAModule) {
  const boost::json::object buses{
      {"buses", boost::json::array{{{"name", "bench"}, {"link", "can:can0"}, {"state", "open"}}}}};
  target.results = {buses, buses};
  target.result = {{"findings", boost::json::array{finding("bus", "b", false)}}};
  ASSERT_EQ(run({"doctor", "1"}), ExitCode::done) << err;
  EXPECT_THAT(target.calls.back(), HasSubstr(R"(doctor.examine {"axis":"x"})"));
  target.results = {buses, buses};
  EXPECT_EQ(run({"doctor", "7"}), ExitCode::done) << err;
  EXPECT_THAT(target.calls.back(), HasSubstr(R"(doctor.examine {"axis":"bench:7/0"})"));
}

}  // namespace
}  // namespace tmclctl::test

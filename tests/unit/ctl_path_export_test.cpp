// path check --legs --as: what other programs are given is read back, by our assembler and
// simulator.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "support/program_host.hpp"
#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"
#include "unit/sim_fixture.hpp"

namespace tmclctl::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using tmcl::Command;

constexpr std::int32_t microsteps_per_unit = 1000;

class CtlPathExport : public tmcl::sim::SimTest {
 protected:
  CtlPathExport() {
    std::ofstream(path) << "G1 X10 Y4 F1200\nG1 Y10\nG4 P0.2\nG1 X-3\n";
    add(6212);
  }
  ~CtlPathExport() override { std::filesystem::remove(path); }

  std::string exported(const std::string& form) {
    EXPECT_EQ(ctl.run({"path", "check", path, "--velocity", "20", "--acceleration", "500", "--legs",
                       "--microsteps-per-unit", std::to_string(microsteps_per_unit), "--as", form}),
              ExitCode::done)
        << ctl.err;
    return ctl.out;
  }
  double place(std::uint8_t motor) {
    return static_cast<double>(get(tmcl::axis_parameter::actual_position, motor)) /
           microsteps_per_unit;
  }
  void expect_at(double x, double y) {
    EXPECT_EQ(place(0), x);
    EXPECT_EQ(place(1), y);
  }

  const std::string path = tmcl::test::temp_path("ctl_path_export_test");
  CtlBench ctl;
};

/// How far a point is from the line between two others.
double off_line(double x, double y, std::array<double, 2> from, std::array<double, 2> to) {
  const double dx = to[0] - from[0];
  const double dy = to[1] - from[1];
  const double part =
      std::clamp(((x - from[0]) * dx + (y - from[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - from[0] - part * dx, y - from[1] - part * dy);
}

TEST_F(CtlPathExport, NothingThatAModuleWouldRefuse) {
  for (const char* form : {"sap", "tmc", "c"}) {
    EXPECT_EQ(ctl.run({"path", "check", path, "--legs", "--microsteps-per-unit", "1000000", "--as",
                       form}),
              ExitCode::usage);
    EXPECT_EQ(ctl.out, "");
    EXPECT_THAT(ctl.err, HasSubstr("its register holds 8388096 at most"));
    EXPECT_THAT(ctl.err, HasSubstr("--microsteps-per-unit"));
  }
}

// Both axes of a leg need the same time, so they keep to its line.
TEST_F(CtlPathExport, AProgramPassesThePath) {
  const auto program = tmcl::sim::assembled(exported("tmc"));
  ASSERT_TRUE(ask(Command::START_DOWNLOAD, 0, 0));
  for (const auto& line : program) ask(line.command, line.type, line.motor, line.value);
  ASSERT_TRUE(ask(Command::END_DOWNLOAD, 0, 0));
  ASSERT_EQ(status_of(Command::RUN_APPLICATION, 1, 0), tmcl::Status::ok);
  const std::vector<std::array<double, 2>> corners{{0, 0}, {10, 4}, {10, 10}, {-3, 10}};
  std::size_t leg = 0;
  for (int ms = 0; ms < 4000; ++ms) {
    pass(milliseconds(1));
    const double x = place(0);
    const double y = place(1);
    double off = off_line(x, y, corners[leg], corners[leg + 1]);
    if (off > 0.05 && leg + 2 < corners.size())
      off = off_line(x, y, corners[leg + 1], corners[leg + 2]), ++leg;
    ASSERT_LT(off, 0.05) << "at " << x << ", " << y << " in leg " << leg;
  }
  EXPECT_EQ(leg, 2U);
  expect_at(-3, 10);
}

TEST_F(CtlPathExport, LinesAreTakenByAModuleLegByLeg) {
  const auto text = exported("sap");
  EXPECT_THAT(text, HasSubstr("// Motors: 0 X, 1 Y."));
  for (const auto& line : tmcl::sim::assembled(text + "STOP\n")) {
    if (line.command == Command::STOP) continue;
    ASSERT_EQ(line.command, Command::SAP);
    EXPECT_EQ(status_of(line.command, line.type, line.motor, line.value), tmcl::Status::ok);
    // Both axes of the first leg start together.
    const bool starts = line.type == tmcl::axis_parameter::target_position;
    if (starts && !(line.motor == 0 && line.value == 10'000)) pass(std::chrono::seconds(2));
  }
  expect_at(-3, 10);
}

TEST_F(CtlPathExport, RefusesWhatCannotBe) {
  const auto complaint = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"path", "check", path});
    EXPECT_EQ(ctl.run(more), ExitCode::usage) << ctl.out;
    return ctl.err;
  };
  EXPECT_THAT(complaint({"--legs", "--as", "json"}), HasSubstr("'json' is none of sap, tmc and c"));
  EXPECT_THAT(complaint({"--legs", "--as", "tmc"}), HasSubstr("--microsteps-per-unit"));
}

}  // namespace
}  // namespace tmclctl::test

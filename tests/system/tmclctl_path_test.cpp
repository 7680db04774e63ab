// tmclctl path run and mint run against a simulated module on a pty.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "support/build_paths.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A TMCM-6212, and a folder for files.
class PathBench : public testing::Test {
 protected:
  PathBench() {
    std::string name = std::filesystem::temp_directory_path() / "tmclctl-path-XXXXXX";
    folder = ::mkdtemp(name.data());
    simulator =
        std::make_unique<Program>(Words{"tmclsim", "--module", "TMCM-6212", "--pty", file("bus")});
    if (!simulator->wait_for("ready")) throw std::runtime_error(simulator->output());
    for (const std::string axis : {"1/0", "1/1"}) {
      set(axis, "4", "200000");
      set(axis, "5", "2000000");
      set(axis, "17", "2000000");
    }
  }
  ~PathBench() override {
    simulator.reset();
    std::filesystem::remove_all(folder);
  }

  std::string file(const std::string& name) const { return folder / name; }
  std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    return file(name);
  }
  Ran ctl(const std::string& words) const {
    const auto finished =
        run_program({"/bin/sh", "-c",
                     "exec '" TMCL_BIN_DIR "/tmclctl' --direct serial:" + file("bus") + "@115200 " +
                         words + " >'" + file("out") + "' 2>'" + file("err") + "'"});
    return {finished.status, contents(file("out")), contents(file("err"))};
  }
  std::string get(const std::string& axis, const std::string& parameter) const {
    return ctl("get " + axis + ' ' + parameter).out;
  }
  void set(const std::string& axis, const std::string& parameter, const std::string& value) const {
    EXPECT_EQ(ctl("set " + axis + ' ' + parameter + ' ' + value).status, 0);
  }

  std::filesystem::path folder;
  std::unique_ptr<Program> simulator;
};

const std::string on_both_axes = " --axis X=1/0 --axis Y=1/1 --per-turn 5 ";

// In its own process tmclctl is the gateway: it must not come a second late. Position mode, whose
// legs are short, is passed on virtual time: see GalleryCircle.
TEST_F(PathBench, ACircleOfGcode) {
  const auto part = written("circle.ngc", circle);
  const auto ran = ctl("--json path run " + part + on_both_axes +
                       "--period 100 --deviation 12 --svg '" + file("path.svg") + "'");
  ASSERT_EQ(ran.status, 0) << ran.out << ran.err;
  const auto document = boost::json::parse(ran.out).as_object();
  const auto& tracking = document.at("tracking_error").as_array();
  ASSERT_EQ(tracking.size(), 2U);
  EXPECT_GT(tracking[0].at("readings").to_number<int>(), 5);
  EXPECT_GT(document.at("commands_per_s").to_number<double>(), 1);
  EXPECT_GT(document.at("passed_s").to_number<double>(), 1.2);
  EXPECT_FALSE(document.contains("seen"));
  EXPECT_THAT(contents(file("path.svg")), AllOf(HasSubstr(">seen</text>"), HasSubstr("<circle"),
                                                HasSubstr(" off the path, at ")));
  EXPECT_EQ(get("1/0", "1"), "10240\n");
  EXPECT_EQ(get("1/1", "1"), "0\n");
  EXPECT_EQ(get("1/0", "20"), "10\n");
  EXPECT_EQ(get("1/0", "4"), "200000\n");
}

TEST_F(PathBench, APictureThatGoesIntoAPipeIsDrawnOnce) {
  const auto part = written("short.ngc", "G1 X1 Y1 F600\n");
  const auto ran = ctl("path run " + part + on_both_axes +
                       "--period 100 --deviation 12 --svg /dev/stdout | cat");
  EXPECT_THAT(ran.out, HasSubstr(" off the path, at "));
  EXPECT_EQ(ran.out.find("<svg xmlns"), ran.out.rfind("<svg xmlns"));
}

TEST_F(PathBench, ADryRunMovesNothingAndDraws) {
  const auto part = written("circle.ngc", circle);
  const auto ran =
      ctl("path run " + part + on_both_axes + "--dry-run --svg '" + file("path.svg") + "'");
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("TOP SPEED"));
  EXPECT_THAT(contents(file("path.svg")), HasSubstr("curve position"));
  EXPECT_EQ(get("1/0", "1"), "0\n");
}

TEST_F(PathBench, WhatCannotBeMovesNothing) {
  const auto part = written("circle.ngc", circle);
  const auto missing = ctl("path run " + part + " --axis X=1/0 --per-turn 5");
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("the file moves Y: which axis is that?"));
  const auto unit = ctl("path run " + part + " --axis X=1/0 --axis Y=1/1");
  EXPECT_EQ(unit.status, 2);
  EXPECT_THAT(unit.err, HasSubstr("--per-turn"));
  const auto far = ctl("path run " + written("far.ngc", "G1 X900000 Y0 F600\n") + on_both_axes);
  EXPECT_EQ(far.status, 2);
  EXPECT_THAT(far.err, HasSubstr("the path goes to X 900000"));
  EXPECT_EQ(get("1/0", "1"), "0\n");
}

TEST_F(PathBench, CtrlCStopsAllAxes) {
  const auto part = written("long.ngc", "G1 X80 Y40 F300\n");
  OnTerminal terminal({"--direct", "serial:" + file("bus") + "@115200"},
                      {"path", "run", part, "--axis", "X=1/0", "--axis", "Y=1/1", "--per-turn", "5",
                       "--period", "100", "--deviation", "12"});
  ASSERT_TRUE(terminal.wait_for("running"));
  terminal.press_ctrl_c();
  EXPECT_EQ(terminal.wait(), 130) << terminal.output();
  EXPECT_THAT(terminal.output(), HasSubstr("stopped before the end of the path"));
  EXPECT_EQ(get("1/0", "3"), "0\n");
  EXPECT_EQ(get("1/1", "3"), "0\n");
}

// The exercise of application note AN00115-001, as printed.
TEST_F(PathBench, TheExerciseOfTheNoteRuns) {
  const auto program = written("exercise.mint",
                               "SCALE = 1200\nSPEED = 250\nACCEL = 1250\nDECEL = 1250\n"
                               "MOVER = 200\nGO\n");
  const auto ran = ctl("mint run " + program + " --axis 0=1/0");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("GO of line 6"));
  EXPECT_THAT(ran.out, HasSubstr("planned 1.000 s"));
  EXPECT_EQ(get("1/0", "1"), "240000\n");
  EXPECT_EQ(get("1/0", "4"), "200000\n");
  const auto again = ctl("mint run " + program + " --axis 1=1/1");
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("--axis 0=NAME"));
}

TEST_F(PathBench, AGoOfTwoAxesStartsThemByOneCommand) {
  const auto program = written("two.mint",
                               "SPEED = 100000, 50000\nACCEL = 1000000, 500000\n"
                               "MOVEA = 20000, -10000\nGO\n");
  const auto ran = ctl("mint run " + program + " --axis 0=1/0 --axis 1=1/1");
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(get("1/0", "1"), "20000\n");
  EXPECT_EQ(get("1/1", "1"), "-10000\n");
  EXPECT_THAT(ctl("coordinate get 1/1 0").out, HasSubstr("-10000")) << "loaded before the start";
}

}  // namespace
}  // namespace tmcl::test

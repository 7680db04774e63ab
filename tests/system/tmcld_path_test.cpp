// tmclctl path run through tmcld, on a simulated module on a pty.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <utility>

#include "support/build_paths.hpp"
#include "system/tmclctl_bench.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;

const std::string own_velocity = "200000\n";
const std::string own_acceleration = "1999899\n";  // the nearest to 2000000 that it can do

/// A TMCM-6212 with tmcld on it, and a folder for files.
class TmcldPath : public testing::Test {
 protected:
  TmcldPath() {
    std::string name = std::filesystem::temp_directory_path() / "tmcld-path-XXXXXX";
    folder = ::mkdtemp(name.data());
    simulator =
        std::make_unique<Program>(Words{"tmclsim", "--module", "TMCM-6212", "--pty", file("bus")});
    if (!simulator->wait_for("ready")) throw std::runtime_error(simulator->output());
    std::ofstream(file("tmcld.toml"))
        << "[daemon]\nsocket = \"" << file("socket") << "\"\n[[bus]]\nname = \"bench\"\nlink = \""
        << link() << "\"\nreply_timeout_ms = 1000\n"
        << axis("left", 0) << axis("front", 1);
    daemon = std::make_unique<Program>(Words{"tmcld", "--config", file("tmcld.toml")});
    if (!daemon->wait_for("module_answers (module 1)")) throw std::runtime_error(daemon->output());
    for (const std::string name_of_axis : {"left", "front"}) {
      for (const std::string setting : {" 4 200000", " 5 2000000", " 17 2000000"})
        EXPECT_EQ(ctl("set " + name_of_axis + setting).status, 0);
    }
  }
  ~TmcldPath() override {
    daemon.reset();
    simulator.reset();
    std::filesystem::remove_all(folder);
  }

  std::string file(const std::string& name) const { return folder / name; }
  std::string link() const { return "serial:" + file("bus") + "@115200"; }
  std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    return file(name);
  }
  Ran run(const std::string& how, const std::string& words) const {
    const auto finished = run_program({"/bin/sh", "-c",
                                       "exec '" TMCL_BIN_DIR "/tmclctl' " + how + ' ' + words +
                                           " >'" + file("out") + "' 2>'" + file("err") + "'"});
    return {finished.status, contents(file("out")), contents(file("err"))};
  }
  Ran ctl(const std::string& words) const { return run("--socket " + file("socket"), words); }
  std::string get(const std::string& axis_name, const std::string& parameter) const {
    return ctl("get " + axis_name + ' ' + parameter).out;
  }
  /// Without tmcld, which has ended.
  std::string get_directly(int motor, const std::string& parameter) const {
    return run("--direct " + link(), "get 1/" + std::to_string(motor) + ' ' + parameter).out;
  }
  bool until_it_reads(const std::string& axis_name, const std::string& parameter,
                      const std::string& value) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (get(axis_name, parameter) != value) {
      if (std::chrono::steady_clock::now() > end) return false;
      ::usleep(10'000);
    }
    return true;
  }
  bool until_left_is_beyond(int microsteps) const {
    for (int i = 0; i < 500; ++i) {
      if (std::stoi(get("left", "1")) > microsteps) return true;
      ::usleep(10'000);
    }
    return false;
  }
  Words path_run(const std::string& path, const std::string& mode = "velocity") const {
    return {"path",   "run", path,       "--axis", "X=left",      "--axis", "Y=front",
            "--mode", mode,  "--period", "100",    "--deviation", "12"};
  }
  Words through_daemon() const { return {"--socket", file("socket")}; }
  void expect_rest_and_own_settings() const {
    for (const std::string name : {"left", "front"}) {
      EXPECT_EQ(get(name, "3"), "0\n");
      EXPECT_EQ(get(name, "4"), own_velocity);
      EXPECT_EQ(get(name, "5"), own_acceleration);
      EXPECT_EQ(get(name, "20"), "10\n");
    }
  }

  std::filesystem::path folder;
  std::unique_ptr<Program> simulator;
  std::unique_ptr<Program> daemon;

 private:
  static std::string axis(const std::string& name, int motor) {
    return "[[axis]]\nname = \"" + name +
           "\"\nbus = \"bench\"\naddress = 1\nmotor = " + std::to_string(motor) +
           "\nunit = \"mm\"\nscrew_pitch = 5\nsoft_limits = [-10, 100]\n";
  }
};

const std::string three_seconds = "G1 X30 Y20 F900\nG1 X40 Y10\n";
constexpr int microsteps_per_mm = 10'240;

std::string joined(const Words& words) {
  std::string line;
  for (const auto& word : words) line += " '" + word + "'";
  return line;
}

// An update may come a second late. The short legs of position mode may not: they are passed on
// virtual time, see GalleryCircle.
TEST_F(TmcldPath, ACircleOfGcode) {
  const auto ran = ctl("--json" + joined(path_run(written("circle.ngc", circle))));
  ASSERT_EQ(ran.status, 0) << ran.out << ran.err;
  const auto document = boost::json::parse(ran.out).as_object();
  EXPECT_EQ(document.at("tracking_error").as_array().size(), 2U);
  EXPECT_GT(document.at("passed_s").to_number<double>(), 1.2);
  EXPECT_EQ(get("left", "1"), "10240\n");
  EXPECT_EQ(get("front", "1"), "0\n");
  expect_rest_and_own_settings();
}

TEST_F(TmcldPath, WhatTmcldRefusesMovesNothing) {
  const auto far = ctl(joined(path_run(written("far.ngc", "G1 X50 Y120 F900\n"))));
  EXPECT_EQ(far.status, 1);
  EXPECT_THAT(far.err, HasSubstr("beyond the soft limit of 100 mm"));
  const auto nothing = ctl("path pause left");
  EXPECT_NE(nothing.status, 0);
  EXPECT_THAT(nothing.err, HasSubstr("'left' is on no path"));
  EXPECT_EQ(get("left", "1"), "0\n");
}

TEST_F(TmcldPath, CtrlZPausesAndGoesOnAndCtrlCStops) {
  const auto part = written("long.ngc", three_seconds);
  OnTerminal terminal(through_daemon(), path_run(part));
  ASSERT_TRUE(terminal.wait_for("running"));
  terminal.press_ctrl_z();
  ASSERT_TRUE(terminal.wait_for("pausing"));
  ASSERT_TRUE(until_it_reads("left", "3", "0\n"));
  const int stood = std::stoi(get("left", "1"));
  ::usleep(300'000);
  EXPECT_NEAR(std::stoi(get("left", "1")), stood, microsteps_per_mm / 100);
  terminal.press_ctrl_z();
  ASSERT_TRUE(until_left_is_beyond(stood + microsteps_per_mm));
  terminal.press_ctrl_c();
  EXPECT_EQ(terminal.wait(), 130) << terminal.output();
  EXPECT_THAT(terminal.output(), HasSubstr("stopped before the end of the path"));
  expect_rest_and_own_settings();
  EXPECT_LT(std::stoi(get("left", "1")), 40 * microsteps_per_mm);
}

TEST_F(TmcldPath, AnotherTerminalPausesResumesAndStops) {
  const auto part = written("long.ngc", three_seconds);
  OnTerminal terminal(through_daemon(), path_run(part));
  ASSERT_TRUE(until_left_is_beyond(microsteps_per_mm));
  EXPECT_EQ(ctl("path pause").status, 0);
  ASSERT_TRUE(terminal.wait_for("pausing"));
  EXPECT_EQ(ctl("path resume front").status, 0);
  EXPECT_EQ(ctl("path stop left").status, 0);
  expect_rest_and_own_settings();
  EXPECT_EQ(terminal.wait(), 5) << terminal.output();
  EXPECT_THAT(terminal.output(), HasSubstr("a client has stopped the path"));
}

TEST_F(TmcldPath, AClientThatIsKilledDoesNotEndIt) {
  const auto part = written("long.ngc", three_seconds);
  {
    OnTerminal terminal(through_daemon(), path_run(part));
    ASSERT_TRUE(until_left_is_beyond(microsteps_per_mm));
  }  // SIGKILL
  ASSERT_TRUE(until_it_reads("left", "1", "409600\n"));
  EXPECT_EQ(get("front", "1"), "102400\n");
  for (const std::string name : {"left", "front"})
    ASSERT_TRUE(until_it_reads(name, "4", own_velocity));
  expect_rest_and_own_settings();
}

TEST_F(TmcldPath, KilledItLeavesAxesThatComeToRestOnThePath) {
  const auto part = written("long.ngc", three_seconds);
  // Where left turns round next, and where its leg ends: by positions it may go on to brake.
  constexpr int turns_at = 409600;
  constexpr int leg_ends_at = 307200;
  for (const auto& [mode, least] :
       {std::pair{"velocity", turns_at}, std::pair{"position", leg_ends_at}}) {
    SCOPED_TRACE(mode);
    OnTerminal terminal(through_daemon(), path_run(part, mode));
    ASSERT_TRUE(until_left_is_beyond(5 * microsteps_per_mm));
    daemon->signal(SIGKILL);
    daemon->wait();
    for (int motor = 0; motor < 2; ++motor) {
      for (int i = 0; i < 1000 && get_directly(motor, "3") != "0\n"; ++i) ::usleep(10'000);
      EXPECT_EQ(get_directly(motor, "3"), "0\n");
    }
    const auto left_stands_at = std::stoi(get_directly(0, "1"));
    EXPECT_GE(left_stands_at, least);
    EXPECT_LE(left_stands_at, turns_at);
    EXPECT_EQ(get_directly(1, "1"), "204800\n");
    daemon = std::make_unique<Program>(Words{"tmcld", "--config", file("tmcld.toml")});
    ASSERT_TRUE(daemon->wait_for("module_answers (module 1)"));
    for (const std::string name : {"left", "front"})
      ASSERT_TRUE(until_it_reads(name, "4", own_velocity)) << "as the journal says";
    expect_rest_and_own_settings();
    for (const std::string name : {"left", "front"}) {
      const auto moved = ctl("move " + name + " 0 --wait");
      ASSERT_EQ(moved.status, 0) << moved.err;
    }
  }
}

TEST_F(TmcldPath, TheEndOfTmcldStopsTheAxes) {
  const auto part = written("long.ngc", three_seconds);
  for (const std::string mode : {"velocity", "position"}) {
    SCOPED_TRACE(mode);
    OnTerminal terminal(through_daemon(), path_run(part, mode));
    ASSERT_TRUE(until_left_is_beyond(microsteps_per_mm));
    daemon->signal(SIGTERM);
    EXPECT_EQ(daemon->wait(), 0);
    EXPECT_EQ(terminal.wait(), 5) << terminal.output();
    EXPECT_THAT(terminal.output(), HasSubstr("tmcld is ending"));
    for (int motor = 0; motor < 2; ++motor) {
      EXPECT_EQ(get_directly(motor, "3"), "0\n");
      EXPECT_EQ(get_directly(motor, "4"), own_velocity);
      EXPECT_EQ(get_directly(motor, "5"), own_acceleration);
      EXPECT_EQ(get_directly(motor, "20"), "10\n");
    }
    EXPECT_LT(std::stoi(get_directly(0, "1")), 40 * microsteps_per_mm);
    daemon = std::make_unique<Program>(Words{"tmcld", "--config", file("tmcld.toml")});
    ASSERT_TRUE(daemon->wait_for("module_answers (module 1)"));
    ASSERT_EQ(ctl("move left 0 --wait").status, 0);
  }
}

}  // namespace
}  // namespace tmcl::test

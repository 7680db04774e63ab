// The verbs that are methods of tmcld: what they ask for, and how they show the answer.
#include <fstream>

#include <gmock/gmock.h>

#include "sim/module/module.hpp"
#include "support/temp_path.hpp"
#include "tmcl/program.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using test::CtlBench;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

const std::string more_in_mm = "unit = \"mm\"\nunits_per_revolution = 5\n";
const std::string three_axes =
    test::axis_in_mm + test::axis_section("y", 1, 1, more_in_mm) + test::axis_section("z", 1, 2);

/// Its program memory is empty.
struct BenchOf6212 : CtlBench {
  BenchOf6212() : CtlBench(three_axes, "TMCM-6212") {
    for (std::uint8_t motor = 0; motor < 2; ++motor) {
      set("max_velocity", 240'000, motor);
      for (const auto* name : {"max_acceleration", "max_deceleration"}) set(name, 4'999'922, motor);
    }
  }
  /// It takes two seconds.
  void let_another_program_pass_a_path() {
    other_after({}, "path.run",
                {{"axes", boost::json::array{"x", "y"}},
                 {"text", "G1 X20 Y10 F1200\nG1 X40 Y0\n"},
                 {"name", "part.ngc"},
                 {"deviation", 4}});
    pass(std::chrono::milliseconds(500));
  }
};

class CtlMethods : public testing::Test {
 protected:
  BenchOf6212 ctl;
  std::string file(const std::string& name, const std::string& contents) {
    const auto path = tmcl::test::temp_path(name);
    std::ofstream(path, std::ios::binary) << contents;
    return path;
  }
};

TEST_F(CtlMethods, EveryVerbAsksForItsMethod) {
  struct Line {
    std::vector<std::string> words;
    std::string call;
    ExitCode exit = ExitCode::done;
  };
  const std::vector<Line> lines{
      {{"store", "x", "max_velocity"},
       R"(parameter.store {"axis":"x","parameter":"max_velocity"})"},
      {{"restore", "x", "4"}, R"(parameter.restore {"axis":"x","parameter":"4"})"},
      {{"global", "get", "1", "66"}, R"(global.get {"bus":"bench","address":1,"parameter":"66"})"},
      {{"global", "set", "bench:1", "5", "-7", "--bank", "2"},
       R"(global.set {"bus":"bench","address":1,"parameter":"5","bank":2,"value":-7})"},
      {{"global", "store", "1", "5", "--bank", "2"},
       R"(global.store {"bus":"bench","address":1,"parameter":"5","bank":2})"},
      {{"input", "1", "0", "--bank", "1"},
       R"(io.get {"bus":"bench","address":1,"bank":1,"port":0})"},
      {{"output", "1", "2", "1"}, R"(io.set {"bus":"bench","address":1,"port":2,"value":1})"},
      {{"output", "1", "2"}, R"(io.get {"bus":"bench","address":1,"bank":2,"port":2})"},
      {{"coordinate", "start", "1", "3", "0", "2", "--arrive-together"},
       R"(coordinate.start {"bus":"bench","address":1,"motors":[0,2],"interpolated":true,"number":3})"},
      {{"coordinate", "start", "bench:1", "0", "5"},
       R"(coordinate.start {"bus":"bench","address":1,"motors":[5],"number":0})"},
      {{"arrivals", "1", "--off"},
       R"(module.report_arrivals {"bus":"bench","address":1,"motors":[],"every":true})"},
      {{"info", "1"}, R"(module.info {"bus":"bench","address":1})"},
      {{"reset", "1"}, R"(module.reset {"bus":"bench","address":1})"},
      {{"factory-reset", "1", "--yes"}, R"(module.factory_reset {"bus":"bench","address":1})"},
      {{"coordinate", "set", "z", "3", "-50"},
       R"(coordinate.set {"axis":"z","number":3,"position":"-50"})"},
      {{"coordinate", "move", "x", "3"}, R"(coordinate.move {"axis":"x","number":3})"},
      {{"coordinate", "store", "x"}, R"(coordinate.store {"axis":"x"})"},
      {{"program", "run", "1", "--start", "7"},
       R"(program.run {"bus":"bench","address":1,"first_address":7})"},
      {{"program", "stop", "1"}, R"(program.stop {"bus":"bench","address":1})"},
      {{"program", "breakpoint", "1", "9"},
       R"(program.set_breakpoint {"bus":"bench","address":1,"at":9})"},
      {{"path", "pause", "x"}, R"(path.pause {"axes":["x"]})", ExitCode::refused},
      {{"path", "resume"}, R"(path.resume {})"},
      {{"path", "feed", "x", "62.5%"},
       R"(path.feed {"axes":["x"],"factor":6.25E-1})",
       ExitCode::refused},
      {{"path", "feed", "x", "hold"}, R"(path.feed {"axes":["x"],"hold":true})", ExitCode::refused},
      {{"path", "feed", "x", "resume"},
       R"(path.feed {"axes":["x"],"hold":false})",
       ExitCode::refused},
      {{"path", "status"}, R"(path.status {})"},
      {{"path", "status", "x"}, R"(path.status {"axes":["x"]})", ExitCode::refused},
      {{"path", "stop", "x", "y"}, R"(path.stop {"axes":["x","y"]})", ExitCode::refused},
      {{"home", "x", "--stop"}, R"(axis.stop_home {"axis":"x"})"},
      {{"home", "x", "--no-wait", "--mode", "5"}, R"(axis.start_home {"axis":"x","mode":5})"},
      {{"home", "x", "--timeout", "2.5"},
       R"(axis.home {"axis":"x","timeout_ms":2500})",
       ExitCode::not_reached},
  };
  for (const auto& line : lines) {
    BenchOf6212 one;
    EXPECT_EQ(one.run(line.words), line.exit) << line.call << one.err;
    EXPECT_THAT(one.calls_of(line.call.substr(0, line.call.find(' '))), ElementsAre(line.call));
  }
}

TEST_F(CtlMethods, WhatGoesOnIsSaid) {
  ctl.run({"program", "stop", "1"});
  EXPECT_EQ(ctl.out,
            "module 1: the program has ended\n"
            "Motors that turn go on. Stop them with: tmclctl --direct can:can0 stop AXIS\n");
  ctl.run({"program", "step", "bench:1"});
  EXPECT_EQ(ctl.out, "module bench:1: one command of the program was executed\n");
  ctl.run({"program", "breakpoint", "1", "9"});
  EXPECT_EQ(ctl.out, "module 1: the program will stand before command 9\n");
  ctl.let_another_program_pass_a_path();
  ctl.run({"path", "pause"});
  EXPECT_EQ(ctl.out, "x, y: paused on the path\n");
  ctl.run({"path", "resume"});
  EXPECT_EQ(ctl.out, "x, y: going on along the path\n");
  ctl.run({"path", "stop"});
  EXPECT_EQ(ctl.out, "x, y: the path has ended, and all of its axes were stopped\n");
  ctl.let_another_program_pass_a_path();
  EXPECT_EQ(ctl.json({"path", "stop"}).at("axes").as_array().size(), 2U);
  ctl.run({"path", "stop"});
  EXPECT_EQ(ctl.out, "No axis is on a path that tmcld passes\n");
}

TEST_F(CtlMethods, ThePathIsToldHowFastToGo) {
  ctl.let_another_program_pass_a_path();
  ctl.run({"path", "feed", "x", "50%"});
  EXPECT_THAT(ctl.out, ContainsRegex("^x, y: override 50 %, (100|9[0-9]) % now\n$")) << ctl.err;
  ctl.run({"path", "feed", "x", "hold"});
  EXPECT_THAT(ctl.out, ContainsRegex("^x, y: held on the path; override 50 %, [0-9]+ % now\n$"));
  for (const auto* wrong : {"50", "9%", "201%", "%", "fast", ""})
    EXPECT_EQ(ctl.run({"path", "feed", "x", wrong}), ExitCode::usage) << wrong;
}

TEST_F(CtlMethods, TheStatusOfAPathSaysWhereItIs) {
  ctl.let_another_program_pass_a_path();
  ctl.run({"path", "feed", "x", "50%"});
  ctl.pass(std::chrono::milliseconds(400));
  ctl.run({"path", "status"});
  EXPECT_THAT(ctl.out,
              MatchesRegex(
                  "x, y: part.ngc, velocity mode, running\n"
                  "  done      [0-9]+ %: [0-9.]+ of [0-9.]+ s, [0-9.]+ s left\n"
                  "  line      [12] of the file\n"
                  "  override  50 %, 50 % now\n"
                  "  feed      [0-9.]+ a second, planned [0-9.]+\n"
                  "  off path  [0-9.]+ at most so far, at [0-9.]+ s, and [0-9.]+ ms late on it\n"));
  ctl.run({"path", "feed", "x", "hold"});
  ctl.pass(std::chrono::milliseconds(400));
  ctl.run({"path", "status", "x"});
  EXPECT_THAT(ctl.out, ContainsRegex("  done      [0-9]+ %: [0-9.]+ of [0-9.]+ s, held\n"));
  EXPECT_THAT(ctl.out, ContainsRegex("  override  50 %, and held, 0 % now\n"));
  ctl.run({"path", "stop"});
  ctl.run({"path", "status"});
  EXPECT_EQ(ctl.out, "No axis is on a path that tmcld passes\n");
}

TEST_F(CtlMethods, APathThatWaitsAtM0SaysSo) {
  ctl.other_after({}, "path.run",
                  {{"axes", boost::json::array{"x", "y"}},
                   {"text", "G1 X2 Y1 F1200\nM0\nG1 X4 Y0\n"},
                   {"deviation", 4}});
  ctl.pass(std::chrono::seconds(5));
  ctl.run({"path", "status", "x"});
  EXPECT_THAT(ctl.out, HasSubstr("x, y: a path, velocity mode, "));
  EXPECT_THAT(ctl.out,
              HasSubstr("\n  waiting at M0, line 2: 'tmclctl path resume' lets it go on\n"));
  ctl.run({"path", "feed", "x", "50%"});
  EXPECT_THAT(ctl.out, HasSubstr("x, y: waiting at M0, line 2; override 50 %, "));
}

TEST_F(CtlMethods, HomeSaysThatTheMotorSearches) {
  ctl.run({"home", "x", "--no-wait"});
  EXPECT_EQ(ctl.out,
            "x searches its reference. End it with: tmclctl --direct can:can0 home x --stop\n");
  ctl.run({"home", "x", "--stop"});
  EXPECT_EQ(ctl.out, "x searches no longer\n");
  EXPECT_EQ(ctl.run({"home", "x", "--timeout", "1"}), ExitCode::not_reached);
  EXPECT_THAT(ctl.err, testing::Not(HasSubstr("goes on searching")));
  EXPECT_EQ(ctl.run({"home", "x", "--timeout", "1", "--leave"}), ExitCode::not_reached);
  EXPECT_THAT(ctl.err, HasSubstr("The motor goes on searching. End it with: tmclctl --direct "
                                 "can:can0 home x --stop"));
}

TEST_F(CtlMethods, HomeTakesSeveralAxesOneAfterTheOther) {
  EXPECT_EQ(ctl.run({"home", "z", "x", "--no-wait"}), ExitCode::done);
  EXPECT_THAT(ctl.calls, testing::ElementsAre(R"(axis.start_home {"axis":"z"})",
                                              R"(axis.start_home {"axis":"x"})"));
  EXPECT_EQ(ctl.run({"home"}), ExitCode::usage);
}

TEST_F(CtlMethods, HomeKnowsModesByWords) {
  ctl.run({"home", "x", "--no-wait", "--mode", "left"});
  EXPECT_EQ(ctl.calls.back(), R"(axis.start_home {"axis":"x","mode":1})");
  ctl.run({"home", "x", "--stop"});
  ctl.run({"home", "x", "--no-wait", "--mode", "65"});
  EXPECT_EQ(ctl.calls.back(), R"(axis.start_home {"axis":"x","mode":65})");
  EXPECT_EQ(ctl.run({"home", "x", "--mode", "lfet"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("'lfet' is no mode: a number 1..255, or one of left, right-left"));
}

TEST_F(CtlMethods, OneValueIsPrintedBare) {
  ctl.run({"global", "set", "1", "5", "7", "--bank", "2"});
  ctl.run({"global", "get", "1", "5", "--bank", "2"});
  EXPECT_EQ(ctl.out, "7\n");
  ctl.run({"coordinate", "set", "z", "1", "-5"});
  ctl.run({"coordinate", "get", "z", "1"});
  EXPECT_EQ(ctl.out, "-5\n");
}

TEST_F(CtlMethods, ManyAreLines) {
  ctl.run({"program", "status", "1"});
  EXPECT_THAT(ctl.out, HasSubstr("state                   stopped\n"));
  EXPECT_THAT(ctl.out, ContainsRegex("next_address            [0-9]+\n"));
}

TEST_F(CtlMethods, VersionsAreShownAsPeopleReadThem) {
  ctl.run({"info", "1"});
  EXPECT_THAT(ctl.out, HasSubstr("version                 1.1\n"));
  EXPECT_THAT(ctl.out, HasSubstr("bootloader_version      1.1\n"));
  EXPECT_THAT(ctl.out, HasSubstr("module_id               6212\n"));
  EXPECT_EQ(ctl.json({"info", "1"}).at("version"), 65537);
}

TEST_F(CtlMethods, ArrivalsAreShownUntilTheTimeIsUp) {
  const boost::json::object of_z{{"axis", "z"}, {"position_microsteps", 100}};
  ctl.other_after(std::chrono::seconds(1), "axis.move_to", of_z);
  EXPECT_EQ(ctl.run({"arrivals", "1", "0", "1", "2", "--for", "5"}), ExitCode::done);
  EXPECT_THAT(ctl.out, ContainsRegex("^    1.[0-9]+ s  module 1: motor 2 arrived\n$"));
  EXPECT_THAT(
      ctl.calls_of("module.report_arrivals"),
      ElementsAre(
          R"(module.report_arrivals {"bus":"bench","address":1,"motors":[0,1,2],"every":true})"));
}

TEST_F(CtlMethods, ArrivalsOfTheNextMoveEndWhenAllHaveArrived) {
  const auto move = [&](int after_s, const char* axis, int position) {
    ctl.other_after(std::chrono::seconds(after_s), "axis.move_to",
                    {{"axis", axis}, {"position_microsteps", position}});
  };
  move(1, "y", 100);
  EXPECT_EQ(ctl.json({"arrivals", "bench:1", "1", "--next"}).at("motors").at(0), 1);
  ctl.host.press_ctrl_c_after(std::chrono::seconds(60));
  move(1, "x", 200);
  move(2, "y", 200);
  EXPECT_EQ(ctl.run({"arrivals", "1", "0", "1", "--next"}), ExitCode::done);
  EXPECT_THAT(ctl.out, testing::EndsWith("motor 1 arrived\n"));
  ctl.fail("module.report_arrivals", Error{"refused_by_module",
                                           ErrorKind::failed,
                                           tmcl::Outcome::refused,
                                           "it does not know that",
                                           {}});
  EXPECT_EQ(ctl.run({"arrivals", "1", "0"}), ExitCode::refused);
}

TEST_F(CtlMethods, CommandsThatWouldDoHarmOrNothingAreRefused) {
  EXPECT_EQ(ctl.run({"factory-reset", "1"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("--yes"));
  EXPECT_EQ(ctl.run({"info", "one"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("'one' names no module"));
  EXPECT_EQ(ctl.run({"coordinate", "store", "x", "0"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"home", "x", "--stop", "--no-wait"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"coordinate", "start", "1", "3"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"coordinate", "start", "1", "3", "6"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"arrivals", "1"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"arrivals", "1", "0", "--off"}), ExitCode::usage);
  EXPECT_EQ(ctl.run({"output", "1", "2", "on"}), ExitCode::usage);
  EXPECT_TRUE(ctl.orders().empty());
}

TEST_F(CtlMethods, UploadAssemblesTextAndTakesBytesAsTheyAre) {
  const auto source = file("host_ctl.tmc", "MVP ABS, 0, 5\nSTOP\n");
  const tmcl::program::Program program{{tmcl::Command::MVP, 0, 0, 5}, {tmcl::Command::STOP}};
  const auto bytes = tmcl::program::to_bytes(program);
  const auto binary = file("host_ctl.bin", {bytes.begin(), bytes.end()});
  const auto call = R"(program.load {"bus":"bench","address":1,"program":")" +
                    tmcl::program::to_hex(program) + R"("})";
  for (const auto& path : {source, binary}) {
    BenchOf6212 one;
    EXPECT_EQ(one.run({"program", "upload", path, "1"}), ExitCode::done) << one.err;
    EXPECT_THAT(one.orders(), ElementsAre(call));
    EXPECT_EQ(one.out, "2 commands in module 1, compared\n");
  }
  ctl.run({"program", "upload", source, "1", "--run", "--start", "4"});
  ASSERT_EQ(ctl.orders().size(), 2U);
  EXPECT_EQ(ctl.orders()[1], R"(program.run {"bus":"bench","address":1,"first_address":4})");
}

TEST_F(CtlMethods, AProgramWithProblemsIsNotSent) {
  EXPECT_EQ(ctl.run({"program", "upload", file("host_bad.tmc", "MVPP ABS, 0, 5\n"), "1"}),
            ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("host_bad.tmc:1:1: there is no command 'MVPP'"));
  EXPECT_TRUE(ctl.orders().empty());
}

TEST_F(CtlMethods, DownloadPrintsTextThatMakesTheSameProgram) {
  const tmcl::program::Program program{{tmcl::Command::MVP, 0, 0, 5}, {tmcl::Command::STOP}};
  ctl.run({"program", "upload", file("host_up.tmc", "MVP ABS, 0, 5\nSTOP\n"), "1"});
  EXPECT_EQ(ctl.run({"program", "download", "1"}), ExitCode::done);
  EXPECT_THAT(ctl.out, HasSubstr("MVP"));
  const auto path = tmcl::test::temp_path("host_down.bin");
  EXPECT_EQ(ctl.run({"program", "download", "1", "-o", path}), ExitCode::done);
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(tmcl::program::from_bytes(bytes), program);
}

TEST_F(CtlMethods, CtrlCEndsAnUploadAndSaysWhatIsLeft) {
  ctl.host.press_ctrl_c_after(std::chrono::milliseconds(50));
  std::string source;
  for (int i = 0; i < 100; ++i) source += "MVP ABS, 0, 5\n";
  const auto path = file("host_ctl2.tmc", source + "STOP\n");
  EXPECT_EQ(ctl.run({"program", "upload", path, "1"}), ExitCode::interrupted);
  EXPECT_THAT(ctl.err, HasSubstr("upload again"));
  EXPECT_EQ(ctl.run({"home", "x"}), ExitCode::interrupted);
  EXPECT_THAT(ctl.err, HasSubstr("goes on searching"));
}

}  // namespace
}  // namespace tmclctl

// The verbs that are methods of tmcld: what they ask for, and how they show the answer.
#include <fstream>

#include <gmock/gmock.h>

#include "ctl_fixture.hpp"
#include "tmcl/program.hpp"

namespace tmclctl {
namespace {

using test::Ctl;
using testing::ElementsAre;
using testing::HasSubstr;

class CtlMethods : public testing::Test {
 protected:
  Ctl ctl;
  std::string file(const std::string& name, const std::string& contents) {
    const auto path = testing::TempDir() + name;
    std::ofstream(path, std::ios::binary) << contents;
    return path;
  }
};

TEST_F(CtlMethods, EveryVerbAsksForItsMethod) {
  struct Line {
    std::vector<std::string> words;
    std::string call;
  };
  const std::vector<Line> lines{
      {{"store", "x", "max_velocity"},
       R"(parameter.store {"axis":"x","parameter":"max_velocity"})"},
      {{"restore", "x", "4"}, R"(parameter.restore {"axis":"x","parameter":"4"})"},
      {{"global", "get", "1", "66"}, R"(global.get {"bus":"b","address":1,"parameter":"66"})"},
      {{"global", "set", "b:1", "5", "-7", "--bank", "2"},
       R"(global.set {"bus":"b","address":1,"parameter":"5","bank":2,"value":-7})"},
      {{"global", "store", "1", "5"}, R"(global.store {"bus":"b","address":1,"parameter":"5"})"},
      {{"input", "1", "0", "--bank", "1"}, R"(io.get {"bus":"b","address":1,"bank":1,"port":0})"},
      {{"output", "1", "2", "1"}, R"(io.set {"bus":"b","address":1,"port":2,"value":1})"},
      {{"output", "1", "2"}, R"(io.get {"bus":"b","address":1,"bank":2,"port":2})"},
      {{"coordinate", "start", "1", "3", "0", "2", "--arrive-together"},
       R"(coordinate.start {"bus":"b","address":1,"motors":[0,2],"interpolated":true,"number":3})"},
      {{"coordinate", "start", "b:1", "0", "5"},
       R"(coordinate.start {"bus":"b","address":1,"motors":[5],"number":0})"},
      {{"arrivals", "1", "--off"},
       R"(module.report_arrivals {"bus":"b","address":1,"motors":[],"every":true})"},
      {{"info", "1"}, R"(module.info {"bus":"b","address":1})"},
      {{"reset", "1"}, R"(module.reset {"bus":"b","address":1})"},
      {{"factory-reset", "1", "--yes"}, R"(module.factory_reset {"bus":"b","address":1})"},
      {{"coordinate", "set", "x", "3", "-50"},
       R"(coordinate.set {"axis":"x","number":3,"position":"-50"})"},
      {{"coordinate", "move", "x", "3"}, R"(coordinate.move {"axis":"x","number":3})"},
      {{"coordinate", "store", "x"}, R"(coordinate.store {"axis":"x"})"},
      {{"program", "run", "1", "--start", "7"},
       R"(program.run {"bus":"b","address":1,"first_address":7})"},
      {{"program", "stop", "1"}, R"(program.stop {"bus":"b","address":1})"},
      {{"program", "breakpoint", "1", "9"},
       R"(program.set_breakpoint {"bus":"b","address":1,"at":9})"},
      {{"path", "pause", "x"}, R"(path.pause {"axes":["x"]})"},
      {{"path", "resume"}, R"(path.resume {})"},
      {{"path", "feed", "x", "62.5%"}, R"(path.feed {"axes":["x"],"factor":6.25E-1})"},
      {{"path", "feed", "x", "hold"}, R"(path.feed {"axes":["x"],"hold":true})"},
      {{"path", "feed", "x", "resume"}, R"(path.feed {"axes":["x"],"hold":false})"},
      {{"path", "status"}, R"(path.status {})"},
      {{"path", "status", "x"}, R"(path.status {"axes":["x"]})"},
      {{"path", "stop", "x", "y"}, R"(path.stop {"axes":["x","y"]})"},
      {{"home", "x", "--stop"}, R"(axis.stop_home {"axis":"x"})"},
      {{"home", "x", "--no-wait", "--mode", "5"}, R"(axis.start_home {"axis":"x","mode":5})"},
      {{"home", "x", "--timeout", "2.5"}, R"(axis.home {"axis":"x","timeout_ms":2500})"},
  };
  for (const auto& line : lines) {
    Ctl one;
    EXPECT_EQ(one.run(line.words), ExitCode::done) << line.call << one.err;
    EXPECT_THAT(one.target.calls, ElementsAre(line.call));
  }
}

TEST_F(CtlMethods, WhatGoesOnIsSaid) {
  ctl.run({"program", "stop", "1"});
  EXPECT_EQ(ctl.out,
            "module 1: the program has ended\n"
            "Motors that turn go on. Stop them with: tmclctl --direct can:can0 stop AXIS\n");
  ctl.run({"program", "step", "b:1"});
  EXPECT_EQ(ctl.out, "module b:1: one command of the program was executed\n");
  ctl.run({"program", "breakpoint", "1", "9"});
  EXPECT_EQ(ctl.out, "module 1: the program will stand before command 9\n");
  ctl.target.result = {{"axes", {"x", "y"}}};
  ctl.run({"path", "pause"});
  EXPECT_EQ(ctl.out, "x, y: paused on the path\n");
  ctl.run({"path", "resume"});
  EXPECT_EQ(ctl.out, "x, y: going on along the path\n");
  ctl.run({"path", "stop"});
  EXPECT_EQ(ctl.out, "x, y: the path has ended, and all of its axes were stopped\n");
  EXPECT_EQ(ctl.json({"path", "stop"}).at("axes").as_array().size(), 2U);
  ctl.target.result = {{"axes", boost::json::array{}}};
  ctl.run({"path", "stop"});
  EXPECT_EQ(ctl.out, "No axis is on a path that tmcld passes\n");
}

boost::json::object running_path() {
  return {{"axes", {"x", "y"}}, {"name", "part.ngc"}, {"mode", "velocity"}, {"phase", "running"},
          {"passed_s", 12.34},  {"duration_s", 40},   {"done", 0.3085},     {"left_s", 55.32},
          {"line", 7},          {"held", false},      {"factor", 0.5},      {"factor_now", 0.75},
          {"planned_feed", 20}, {"feed", 15},         {"off_path", 0.0031}, {"off_path_at_s", 3.25},
          {"lag_s", 0.0004}};
}

TEST_F(CtlMethods, ThePathIsToldHowFastToGo) {
  ctl.target.result = {{"paths", boost::json::array{running_path()}}};
  ctl.run({"path", "feed", "x", "50%"});
  EXPECT_EQ(ctl.out, "x, y: override 50 %, 75 % now\n");
  auto held = running_path();
  held["held"] = true;
  ctl.target.result = {{"paths", boost::json::array{held}}};
  ctl.run({"path", "feed", "x", "hold"});
  EXPECT_EQ(ctl.out, "x, y: held on the path; override 50 %, 75 % now\n");
  held["waits_at_line"] = 12;
  ctl.target.result = {{"paths", boost::json::array{held}}};
  ctl.run({"path", "feed", "x", "50%"});
  EXPECT_EQ(ctl.out, "x, y: waiting at M0, line 12; override 50 %, 75 % now\n");
  for (const auto* wrong : {"50", "9%", "201%", "%", "fast", ""})
    EXPECT_EQ(ctl.run({"path", "feed", "x", wrong}), ExitCode::usage) << wrong;
}

TEST_F(CtlMethods, TheStatusOfAPathSaysWhereItIs) {
  ctl.target.result = {{"paths", boost::json::array{running_path()}}};
  ctl.run({"path", "status"});
  EXPECT_EQ(ctl.out,
            "x, y: part.ngc, velocity mode, running\n"
            "  done      31 %: 12.3 of 40.0 s, 55.3 s left\n"
            "  line      7 of the file\n"
            "  override  50 %, 75 % now\n"
            "  feed      15 a second, planned 20\n"
            "  off path  0.0031 at most so far, at 3.250 s, and 0.4 ms late on it\n");
  auto bare = running_path();
  bare["name"] = bare["left_s"] = bare["line"] = nullptr;
  bare["held"] = true;
  ctl.target.result = {{"paths", boost::json::array{bare}}};
  ctl.run({"path", "status", "x"});
  EXPECT_EQ(ctl.out,
            "x, y: a path, velocity mode, running\n"
            "  done      31 %: 12.3 of 40.0 s, held\n"
            "  override  50 %, and held, 75 % now\n"
            "  feed      15 a second, planned 20\n"
            "  off path  0.0031 at most so far, at 3.250 s, and 0.4 ms late on it\n");
  bare["waits_at_line"] = 12;
  ctl.target.result = {{"paths", boost::json::array{bare}}};
  ctl.run({"path", "status", "x"});
  EXPECT_THAT(ctl.out,
              HasSubstr("\n  waiting at M0, line 12: 'tmclctl path resume' lets it go on\n"));
  ctl.target.result = {{"paths", boost::json::array{}}};
  ctl.run({"path", "status"});
  EXPECT_EQ(ctl.out, "No axis is on a path that tmcld passes\n");
}

TEST_F(CtlMethods, HomeSaysThatTheMotorSearches) {
  ctl.run({"home", "x", "--no-wait"});
  EXPECT_EQ(ctl.out,
            "x searches its reference. End it with: tmclctl --direct can:can0 home x --stop\n");
  ctl.run({"home", "x", "--stop"});
  EXPECT_EQ(ctl.out, "x searches no longer\n");
  ctl.target.failure = error_of(ExitCode::not_reached, "deadline_passed", "not found yet");
  EXPECT_EQ(ctl.run({"home", "x", "--timeout", "1"}), ExitCode::not_reached);
  EXPECT_THAT(ctl.err, testing::Not(HasSubstr("goes on")));
  EXPECT_EQ(ctl.run({"home", "x", "--timeout", "1", "--leave"}), ExitCode::not_reached);
  EXPECT_THAT(ctl.err, HasSubstr("The motor goes on searching. End it with: tmclctl --direct "
                                 "can:can0 home x --stop"));
}

TEST_F(CtlMethods, HomeTakesSeveralAxesOneAfterTheOther) {
  EXPECT_EQ(ctl.run({"home", "z", "x", "--no-wait"}), ExitCode::done);
  EXPECT_THAT(ctl.target.calls, testing::ElementsAre(R"(axis.start_home {"axis":"z"})",
                                                     R"(axis.start_home {"axis":"x"})"));
  EXPECT_EQ(ctl.run({"home"}), ExitCode::usage);
}

TEST_F(CtlMethods, HomeKnowsModesByWords) {
  ctl.run({"home", "x", "--no-wait", "--mode", "left"});
  EXPECT_EQ(ctl.target.calls.back(), R"(axis.start_home {"axis":"x","mode":1})");
  ctl.run({"home", "x", "--no-wait", "--mode", "65"});
  EXPECT_EQ(ctl.target.calls.back(), R"(axis.start_home {"axis":"x","mode":65})");
  EXPECT_EQ(ctl.run({"home", "x", "--mode", "lfet"}), ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("'lfet' is no mode: a number 1..255, or one of left, right-left"));
}

TEST_F(CtlMethods, OneValueIsPrintedBare) {
  ctl.target.result = {{"value", 7}, {"number", 66}};
  ctl.run({"global", "get", "1", "66"});
  EXPECT_EQ(ctl.out, "7\n");
  ctl.target.result = {{"position_microsteps", -5}};
  ctl.run({"coordinate", "get", "x", "1"});
  EXPECT_EQ(ctl.out, "-5\n");
}

TEST_F(CtlMethods, ManyAreLines) {
  ctl.target.result = {{"state", "running"}, {"next_address", nullptr}};
  ctl.run({"program", "status", "1"});
  EXPECT_THAT(ctl.out, HasSubstr("state                   running\n"));
  EXPECT_THAT(ctl.out, HasSubstr("next_address            -\n"));
}

TEST_F(CtlMethods, VersionsAreShownAsPeopleReadThem) {
  ctl.target.result = {{"version", 65537}, {"bootloader_version", nullptr}, {"module_id", 65537}};
  ctl.run({"info", "1"});
  EXPECT_THAT(ctl.out, HasSubstr("version                 1.1\n"));
  EXPECT_THAT(ctl.out, HasSubstr("bootloader_version      -\n"));
  EXPECT_THAT(ctl.out, HasSubstr("module_id               65537\n"));
  EXPECT_EQ(ctl.json({"info", "1"}).at("version"), 65537);
}

TEST_F(CtlMethods, ArrivalsAreShownUntilTheTimeIsUp) {
  ctl.target.arrivals = {{0}, {1, 2}};
  EXPECT_EQ(ctl.run({"arrivals", "1", "0", "1", "2", "--for", "5"}), ExitCode::done);
  EXPECT_EQ(ctl.out,
            "    1.000 s  module 1: motor 0 arrived\n"
            "    2.000 s  module 1: motor 1 and motor 2 arrived\n");
  EXPECT_THAT(
      ctl.target.calls,
      ElementsAre(
          R"(module.report_arrivals {"bus":"b","address":1,"motors":[0,1,2],"every":true})"));
}

TEST_F(CtlMethods, ArrivalsOfTheNextMoveEndWhenAllHaveArrived) {
  ctl.target.arrivals = {{1}, {0}, {1}};
  EXPECT_EQ(ctl.json({"arrivals", "b:1", "1", "--next"}).at("motors").at(0), 1);
  ctl.host.press_ctrl_c_after(std::chrono::seconds(60));
  EXPECT_EQ(ctl.run({"arrivals", "1", "0", "1", "--next"}), ExitCode::done);
  EXPECT_THAT(ctl.out, testing::EndsWith("motor 1 arrived\n"));
  ctl.target.failure = error_of(ExitCode::refused, "refused_by_module", "it does not know that");
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
  EXPECT_TRUE(ctl.target.calls.empty());
}

TEST_F(CtlMethods, UploadAssemblesTextAndTakesBytesAsTheyAre) {
  const auto source = file("host_ctl.tmc", "MVP ABS, 0, 5\nSTOP\n");
  const tmcl::program::Program program{{tmcl::Command::MVP, 0, 0, 5}, {tmcl::Command::STOP}};
  const auto bytes = tmcl::program::to_bytes(program);
  const auto binary = file("host_ctl.bin", {bytes.begin(), bytes.end()});
  const auto call = R"(program.load {"bus":"b","address":1,"program":")" +
                    tmcl::program::to_hex(program) + R"("})";
  for (const auto& path : {source, binary}) {
    Ctl one;
    one.target.result = {{"commands", 2}};
    EXPECT_EQ(one.run({"program", "upload", path, "1"}), ExitCode::done) << one.err;
    EXPECT_THAT(one.target.calls, ElementsAre(call));
    EXPECT_EQ(one.out, "2 commands in module 1, compared\n");
  }
  ctl.run({"program", "upload", source, "1", "--run", "--start", "4"});
  ASSERT_EQ(ctl.target.calls.size(), 2U);
  EXPECT_EQ(ctl.target.calls[1], R"(program.run {"bus":"b","address":1,"first_address":4})");
}

TEST_F(CtlMethods, AProgramWithProblemsIsNotSent) {
  EXPECT_EQ(ctl.run({"program", "upload", file("host_bad.tmc", "MVPP ABS, 0, 5\n"), "1"}),
            ExitCode::usage);
  EXPECT_THAT(ctl.err, HasSubstr("host_bad.tmc:1:1: there is no command 'MVPP'"));
  EXPECT_TRUE(ctl.target.calls.empty());
}

TEST_F(CtlMethods, DownloadPrintsTextThatMakesTheSameProgram) {
  const tmcl::program::Program program{{tmcl::Command::MVP, 0, 0, 5}, {tmcl::Command::STOP}};
  ctl.target.result = {{"commands", 2}, {"program", tmcl::program::to_hex(program)}};
  EXPECT_EQ(ctl.run({"program", "download", "1"}), ExitCode::done);
  EXPECT_THAT(ctl.out, HasSubstr("MVP"));
  const auto path = testing::TempDir() + "host_down.bin";
  EXPECT_EQ(ctl.run({"program", "download", "1", "-o", path}), ExitCode::done);
  std::ifstream in(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(tmcl::program::from_bytes(bytes), program);
}

TEST_F(CtlMethods, CtrlCEndsAnUploadAndSaysWhatIsLeft) {
  ctl.host.press_ctrl_c_after({});
  const auto path = file("host_ctl2.tmc", "STOP\n");
  EXPECT_EQ(ctl.run({"program", "upload", path, "1"}), ExitCode::interrupted);
  EXPECT_THAT(ctl.err, HasSubstr("upload again"));
  EXPECT_EQ(ctl.run({"home", "x"}), ExitCode::interrupted);
  EXPECT_THAT(ctl.err, HasSubstr("goes on searching"));
}

}  // namespace
}  // namespace tmclctl

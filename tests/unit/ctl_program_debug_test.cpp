// program debug: what it asks tmcld for, what it prints, and how it ends.
#include <gmock/gmock.h>

#include <fstream>

#include "ctl_fixture.hpp"
#include "support/temp_path.hpp"

namespace tmclctl {
namespace {

using test::Ctl;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class CtlProgramDebug : public testing::Test, public Ctl {
 protected:
  CtlProgramDebug() {
    std::ofstream(file) << "Loop: CALCV ADD, 3, 1\n      MVP ABS, 0, 5\n      JA Loop\n";
    // What is none of a method is left out.
    target.result = {{"state", "stepping"}, {"next_address", 1},
                     {"last_error", 0},     {"reason", "address"},
                     {"steps", 1},          {"unattended", true},
                     {"commands", 3},       {"lease", 7},
                     {"epoch", 9},          {"axes", boost::json::array{"b:1/0"}},
                     {"ttl_ms", 5000},      {"number", 3},
                     {"bank", 2},           {"value", 41}};
  }

  ExitCode debug(std::deque<std::string> lines, const std::vector<std::string>& more = {}) {
    host.lines = std::move(lines);
    std::vector<std::string> words{"program", "debug", file, "1"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  std::vector<std::string> methods() const {
    std::vector<std::string> names;
    for (const auto& call : target.calls) names.push_back(call.substr(0, call.find(' ')));
    return names;
  }

  std::string file = tmcl::test::temp_path("debug.tmc");
};

TEST_F(CtlProgramDebug, BeginsAtTheStartUnderALeaseAndEndsWithStops) {
  EXPECT_EQ(debug({"quit"}), ExitCode::done) << err;
  EXPECT_THAT(methods(), ElementsAre("firmware.status", "program.status", "lease.acquire",
                                     "program.compare", "program.reset", "program.status", "stop",
                                     "program.stop", "stop", "lease.release"));
  EXPECT_THAT(target.calls[2], HasSubstr(R"({"axes":["b:1/0"],"ttl_ms":5000})"));
  EXPECT_THAT(out, StartsWith("module 1 holds the program of "));
  EXPECT_THAT(out, HasSubstr("Not told by modules: accumulator, X, flags, stack."));
  EXPECT_THAT(out, HasSubstr("debug.tmc:2  MVP ABS, 0, 5\n"));
  EXPECT_THAT(out, HasSubstr("module 1: the program has ended, and its motors have stopped\n"));
}

TEST_F(CtlProgramDebug, StepsGoToTheBreakpoints) {
  EXPECT_EQ(debug({"break Loop", "break 2", "step 4", "", "continue"}), ExitCode::done) << err;
  std::vector<std::string> steps;
  for (const auto& call : target.calls)
    if (call.starts_with("program.step_to")) steps.push_back(call);
  EXPECT_THAT(
      steps,
      ElementsAre(R"(program.step_to {"bus":"b","address":1,"until":[0,1],"most_steps":4})",
                  R"(program.step_to {"bus":"b","address":1,"until":[0,1],"most_steps":4})",
                  R"(program.step_to {"bus":"b","address":1,"until":[0,1],"most_steps":10000})"));
  EXPECT_THAT(out, HasSubstr("breakpoint Loop+1 after 1 command\n"));
}

TEST_F(CtlProgramDebug, ShowsVariablesAndWhatIsWatched) {
  target.values["actual_position"] = 512;
  EXPECT_EQ(debug({"variables", "watch 0 actual_position", "step"}), ExitCode::done) << err;
  EXPECT_THAT(out, HasSubstr("      variable 3 = 41\n"));
  EXPECT_THAT(out, HasSubstr("      motor 0 actual_position = 512\n"));
  EXPECT_THAT(target.calls,
              testing::Contains(R"(global.get {"bus":"b","address":1,"parameter":3,"bank":2})"));
}

TEST_F(CtlProgramDebug, LoadsTheFileIfAsked) {
  EXPECT_EQ(debug({}, {"--upload"}), ExitCode::done) << err;
  EXPECT_THAT(methods(), testing::Contains("program.load"));
  EXPECT_THAT(methods(), Not(testing::Contains("program.compare")));
  EXPECT_THAT(out, HasSubstr("debug.tmc was loaded, 3 commands, compared\n"));
}

TEST_F(CtlProgramDebug, ARunningProgramIsLeftAlone) {
  target.result["state"] = "running";
  EXPECT_EQ(debug({"step"}), ExitCode::refused);
  EXPECT_THAT(err, HasSubstr("a program is running on module 1"));
  EXPECT_THAT(methods(), ElementsAre("firmware.status", "program.status"));
}

TEST_F(CtlProgramDebug, CtrlCStopsTheProgramAndTheMotors) {
  host.press_ctrl_c_after(std::chrono::seconds(3));
  EXPECT_EQ(debug({"step"}), ExitCode::interrupted);
  const auto names = methods();
  EXPECT_THAT(std::vector(names.end() - 4, names.end()),
              ElementsAre("stop", "program.stop", "stop", "lease.release"));
  EXPECT_THAT(err, HasSubstr("the program and the motors were stopped"));
}

TEST_F(CtlProgramDebug, JsonIsARowWhereverItStands) {
  host.lines = {"step", "wrong", "watch 3"};
  EXPECT_EQ(run({"--json", "program", "debug", file, "1"}), ExitCode::done) << err;
  std::vector<boost::json::object> rows;
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);)
    rows.push_back(boost::json::parse(line).as_object());
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].at("reason"), "breakpoint");
  EXPECT_EQ(rows[1].at("label"), "Loop+1");
  EXPECT_EQ(rows[1].at("line"), 2);
  EXPECT_EQ(boost::json::serialize(rows[2].at("readings")), R"([{"of":"variable 3","value":41}])");
  EXPECT_THAT(err, HasSubstr("error: 'wrong' is no command"));
}

TEST_F(CtlProgramDebug, AProgramThatHasProblemsIsNotBegun) {
  std::ofstream(file) << "MVPP\n";
  EXPECT_EQ(debug({"step"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(":1:1: there is no command 'MVPP'"));
  EXPECT_THAT(methods(), ElementsAre("firmware.status", "program.status"));
}

}  // namespace
}  // namespace tmclctl

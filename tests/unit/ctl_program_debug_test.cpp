// program debug: what it asks tmcld for, what it prints, and how it ends.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "sim/module/module.hpp"
#include "support/temp_path.hpp"
#include "unit/ctl_bench.hpp"

namespace tmclctl {
namespace {

using test::CtlBench;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class CtlProgramDebug : public testing::Test, public CtlBench {
 protected:
  CtlProgramDebug() {
    write("Loop: CALCV ADD, 3, 1\n      MVP ABS, 0, 5\n      JA Loop\n");
    set_variable_3(40);
  }

  void write(const std::string& program) const { std::ofstream(file) << program; }
  void set_variable_3(int value) { execute(tmcl::Command::SGP, 3, bank_of_variables, value); }
  /// Into the module, which forgets the call then.
  void load() {
    ASSERT_EQ(run({"program", "upload", file, "1"}), ExitCode::done) << err;
    calls.clear();
  }
  ExitCode debug(std::deque<std::string> lines, const std::vector<std::string>& more = {}) {
    host.lines = std::move(lines);
    std::vector<std::string> words{"program", "debug", file, "1"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  std::vector<std::string> methods() const {
    std::vector<std::string> names;
    for (const auto& call : calls) names.push_back(call.substr(0, call.find(' ')));
    return names;
  }

  static constexpr std::uint8_t bank_of_variables = 2;
  std::string file = tmcl::test::temp_path("debug.tmc");
};

TEST_F(CtlProgramDebug, BeginsAtTheStartUnderALeaseAndEndsWithStops) {
  load();
  EXPECT_EQ(debug({"quit"}), ExitCode::done) << err;
  EXPECT_THAT(methods(),
              ElementsAre("bus.list", "firmware.status", "program.status", "lease.acquire",
                          "program.compare", "program.reset", "program.status", "axis.stop",
                          "program.stop", "axis.stop", "lease.release"));
  EXPECT_THAT(calls_of("lease.acquire"),
              ElementsAre(R"(lease.acquire {"axes":["bench:1/0"],"ttl_ms":5000})"));
  EXPECT_THAT(out, StartsWith("module 1 holds the program of "));
  EXPECT_THAT(out, HasSubstr("Not told by modules: accumulator, X, flags, stack."));
  EXPECT_THAT(out, HasSubstr("debug.tmc:1  Loop: CALCV ADD, 3, 1\n"));
  EXPECT_THAT(out, HasSubstr("module 1: the program has ended, and its motors have stopped\n"));
}

TEST_F(CtlProgramDebug, StepsGoToTheBreakpoints) {
  load();
  EXPECT_EQ(debug({"break Loop", "break 2", "step 4", "", "continue"}), ExitCode::done) << err;
  EXPECT_THAT(
      calls_of("program.step_to"),
      ElementsAre(
          R"(program.step_to {"bus":"bench","address":1,"until":[0,1],"most_steps":4})",
          R"(program.step_to {"bus":"bench","address":1,"until":[0,1],"most_steps":4})",
          R"(program.step_to {"bus":"bench","address":1,"until":[0,1],"most_steps":10000})"));
  EXPECT_THAT(out, testing::ContainsRegex("breakpoint Loop\\+1 after 1 command\n.*MVP ABS, 0, 5\n"
                                          "breakpoint Loop after 2 commands\n.*\n"
                                          "breakpoint Loop\\+1 after 1 command\n"));
  EXPECT_EQ(get("actual_position"), 5);
}

TEST_F(CtlProgramDebug, ShowsVariablesAndWhatIsWatched) {
  load();
  place(512);
  EXPECT_EQ(debug({"variables", "watch 0 actual_position", "step", "variables"}), ExitCode::done)
      << err;
  EXPECT_THAT(out, HasSubstr("      variable 3 = 40\n"));
  EXPECT_THAT(out, HasSubstr("      variable 3 = 41"));
  EXPECT_THAT(out, HasSubstr("      motor 0 actual_position = 512\n"));
  EXPECT_THAT(
      calls, testing::Contains(R"(global.get {"bus":"bench","address":1,"parameter":3,"bank":2})"));
}

TEST_F(CtlProgramDebug, LoadsTheFileIfAsked) {
  EXPECT_EQ(debug({}), ExitCode::refused);
  EXPECT_THAT(err, HasSubstr("program debug --upload' loads the file first"));
  calls.clear();
  EXPECT_EQ(debug({}, {"--upload"}), ExitCode::done) << err;
  EXPECT_THAT(methods(), testing::Contains("program.load"));
  EXPECT_THAT(methods(), Not(testing::Contains("program.compare")));
  EXPECT_THAT(out, HasSubstr("debug.tmc was loaded, 3 commands, compared\n"));
}

TEST_F(CtlProgramDebug, ARunningProgramIsLeftAlone) {
  load();
  ASSERT_EQ(run({"program", "run", "1"}), ExitCode::done) << err;
  calls.clear();
  EXPECT_EQ(debug({"step"}), ExitCode::refused);
  EXPECT_THAT(err, HasSubstr("a program is running on module 1"));
  EXPECT_THAT(methods(), ElementsAre("bus.list", "firmware.status", "program.status"));
}

TEST_F(CtlProgramDebug, CtrlCStopsTheProgramAndTheMotors) {
  write("ROR 0, 500\nWAIT TICKS, 0, 500\nSTOP\n");
  load();
  host.press_ctrl_c_after(std::chrono::seconds(3));
  std::int32_t velocity = 0;
  after(std::chrono::seconds(2), [&] { velocity = get("actual_velocity"); });
  EXPECT_EQ(debug({"step 2"}), ExitCode::interrupted);
  const auto names = methods();
  EXPECT_THAT(std::vector(names.end() - 4, names.end()),
              ElementsAre("axis.stop", "program.stop", "axis.stop", "lease.release"));
  EXPECT_THAT(err, HasSubstr("the program and the motors were stopped"));
  EXPECT_EQ(velocity, 500);
  pass(std::chrono::seconds(2));
  EXPECT_EQ(get("actual_velocity"), 0);
}

TEST_F(CtlProgramDebug, JsonIsARowWhereverItStands) {
  load();
  host.lines = {"step", "wrong", "watch 3", "break Loop", "continue"};
  EXPECT_EQ(run({"--json", "program", "debug", file, "1"}), ExitCode::done) << err;
  std::vector<boost::json::object> rows;
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);)
    rows.push_back(boost::json::parse(line).as_object());
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[1].at("reason"), "steps");
  EXPECT_EQ(rows[1].at("label"), "Loop+1");
  EXPECT_EQ(rows[1].at("line"), 2);
  EXPECT_EQ(boost::json::serialize(rows[2].at("readings")), R"([{"of":"variable 3","value":41}])");
  EXPECT_EQ(rows[3].at("reason"), "breakpoint");
  EXPECT_EQ(rows[3].at("label"), "Loop");
  EXPECT_THAT(err, HasSubstr("error: 'wrong' is no command"));
}

TEST_F(CtlProgramDebug, AProgramThatHasProblemsIsNotBegun) {
  write("MVPP\n");
  EXPECT_EQ(debug({"step"}), ExitCode::usage);
  EXPECT_THAT(err, HasSubstr(":1:1: there is no command 'MVPP'"));
  EXPECT_THAT(methods(), ElementsAre("bus.list", "firmware.status", "program.status"));
}

}  // namespace
}  // namespace tmclctl

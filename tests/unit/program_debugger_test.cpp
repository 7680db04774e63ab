// The debugger of stand-alone programs: what is typed, what it asks for, what it prints.
#include <gmock/gmock.h>

#include "tmcl/program_debugger.hpp"

namespace tmcl::program {
namespace {

using Kind = DebugOrder::Kind;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* text =
    "// counts\n"                      // 1
    "#include setup.inc\n"             // 2
    "Loop:   CALCV ADD, 3, 1\n"        // 3, address 1
    "        GGP 3, 2\n"               // 4, address 2
    "        COMP 5\n"                 // 5, address 3
    "        JC LT, Loop  // again\n"  // 6, address 4
    "Done:   STOP\n";                  // 7, address 5

Debugger debugger(bool is_simulated = false) {
  const auto read = [](const std::string& path) -> tl::expected<std::string, std::string> {
    return path == "count.tmc" ? text : "SGP 7, 2, 1\n";
  };
  return {assemble("count.tmc", read).value(),
          {.is_simulated = is_simulated, .most_steps = 900, .motors = 2}};
}

Standing standing(std::int32_t address, std::string reason = "steps", std::uint64_t steps = 1) {
  Standing now;
  now.state = "stepping";
  now.address = address;
  now.reason = std::move(reason);
  now.steps = steps;
  return now;
}

TEST(ProgramDebugger, AsksForSteps) {
  auto session = debugger();
  EXPECT_EQ(session.say("step").kind, Kind::step);
  EXPECT_EQ(session.say("s").steps, 1U);
  EXPECT_EQ(session.say("  STEP   12 ").steps, 12U);
  EXPECT_EQ(session.say("continue").steps, 900U);
  EXPECT_EQ(session.say("c 5").steps, 5U);
  EXPECT_EQ(session.say("q").kind, Kind::quit);
  EXPECT_EQ(session.say("sto").kind, Kind::stop);
  EXPECT_EQ(session.say("rest").kind, Kind::restart);
  EXPECT_EQ(session.say("where").kind, Kind::look);
  EXPECT_EQ(session.say("v").kind, Kind::read);
}

TEST(ProgramDebugger, AnEmptyLineRepeatsWhatGoesOn) {
  auto session = debugger();
  EXPECT_EQ(session.say("").kind, Kind::none);
  session.say("step 3");
  EXPECT_EQ(session.say("").steps, 3U);
  EXPECT_EQ(session.say("\r").steps, 3U);
  session.say("list");
  EXPECT_EQ(session.say("").kind, Kind::none);
}

TEST(ProgramDebugger, SaysWhatIsWrong) {
  auto session = debugger();
  const std::vector<std::pair<std::string, std::string>> lines{
      {"stpe", "error: 'stpe' is no command; 'help' shows them. Did you mean 'step'?\n"},
      {"step 0", "error: '0' is no number of commands: 1 to 1000000\n"},
      {"continue x", "error: 'x' is no number of commands: 1 to 1000000\n"},
      {"quit now", "error: 'now' is too much: it is 'quit'\n"},
      {"step 1 2", "error: '2' is too much: it is 'step [N]'\n"},
      {"break Lop", "error: 'Lop' is no label and no line of the program. Did you mean 'Loop'?\n"},
      {"break 8", "error: no command stands on line 8 of count.tmc, or below\n"},
      {"break gone.inc:1", "error: 'gone.inc:1' is no label and no line of the program.\n"},
      {"delete", "error: which one? It is 'delete LABEL|LINE'\n"},
      {"delete Loop", "error: there is no breakpoint at 'Loop'\n"},
      {"watch",
       "error: what? It is a VARIABLE, 0 to 255, or MOTOR PARAM, such as 0 "
       "actual_position\n"},
      {"watch 256",
       "error: '256' is no number of a user variable, 0 to 255, nor of a motor before "
       "a parameter\n"},
      {"watch 2 actual_position", "error: there is no motor 2: they are 0 to 1\n"},
      {"unwatch 4", "error: variable 4 is not watched\n"},
      {"back", "error: a module cannot go back; a simulated one can: tmclsim --debug FILE\n"},
      {"registers",
       "error: not told by modules: accumulator, X, flags and stack; a simulated "
       "module shows them: tmclsim --debug FILE\n"},
  };
  for (const auto& [line, answer] : lines) {
    const auto order = session.say(line);
    EXPECT_EQ(order.kind, Kind::none) << line;
    EXPECT_EQ(order.text, answer);
    EXPECT_TRUE(order.is_error) << line;
  }
  EXPECT_TRUE(session.say(std::string(201, 's')).is_error);
}

TEST(ProgramDebugger, BreakpointsAreLabelsAndLines) {
  auto session = debugger();
  EXPECT_EQ(session.say("break").text, "no breakpoints\n");
  EXPECT_EQ(session.say("b done").text, "breakpoint before Done, count.tmc:7\n");
  EXPECT_EQ(session.say("b 4").text, "breakpoint before Loop+1, count.tmc:4\n");
  EXPECT_EQ(session.say("b 1").text, "breakpoint before Loop, count.tmc:3\n");
  EXPECT_EQ(session.say("b setup.inc:1").text, "breakpoint before 0, setup.inc:1\n");
  EXPECT_EQ(session.say("b Loop").text, "breakpoint before Loop, count.tmc:3\n") << "again";
  EXPECT_THAT(session.breakpoints(), ElementsAre(0, 1, 2, 5));
  EXPECT_EQ(session.say("break").text,
            "  0                setup.inc:1  SGP 7, 2, 1\n"
            "  Loop             count.tmc:3  Loop:   CALCV ADD, 3, 1\n"
            "  Loop+1           count.tmc:4  GGP 3, 2\n"
            "  Done             count.tmc:7  Done:   STOP\n");
  EXPECT_EQ(session.say("d Done").text, "no breakpoint before Done any more\n");
  EXPECT_THAT(session.breakpoints(), ElementsAre(0, 1, 2));
}

TEST(ProgramDebugger, ShowsWhereTheProgramStands) {
  auto session = debugger();
  EXPECT_EQ(session.stands(Kind::look, standing(0, ""), {}),
            "   0               setup.inc:1  SGP 7, 2, 1\n");
  EXPECT_EQ(session.stands(Kind::step, standing(1), {}),
            "   1  Loop         count.tmc:3  Loop:   CALCV ADD, 3, 1\n");
  EXPECT_EQ(session.stands(Kind::step, standing(2, "breakpoint", 7), {}),
            "breakpoint Loop+1 after 7 commands\n"
            "   2  Loop+1       count.tmc:4  GGP 3, 2\n");
  EXPECT_THAT(session.stands(Kind::step, standing(5, "ended"), {}),
              StartsWith("the program has ended\n   5  Done"));
  auto failed = standing(4, "ended");
  failed.last_error = 4;
  EXPECT_THAT(session.stands(Kind::step, failed, {}),
              StartsWith("the program has failed: error 4 (invalid_value)\n   4  Loop+3"));
  EXPECT_EQ(session.stands(Kind::step, standing(77), {}), "  77  behind the program\n");
  Standing unknown;
  EXPECT_EQ(session.stands(Kind::look, unknown, {}),
            "the module does not tell where its program stands\n");
}

TEST(ProgramDebugger, ShowsWhatIsWatchedAndWhatItWas) {
  auto session = debugger();
  EXPECT_EQ(session.say("watch 3").kind, Kind::look);
  EXPECT_EQ(session.say("watch 1 actual_position").kind, Kind::look);
  session.say("watch 3");
  const auto watched = session.to_read(Kind::step);
  ASSERT_EQ(watched.size(), 2U);
  session.stands(Kind::step, standing(1), {{watched[0], 5}, {watched[1], -800}});
  EXPECT_THAT(
      session.stands(Kind::step, standing(2),
                     {{watched[0], 6}, {watched[1], tl::unexpected(std::string("silent"))}}),
      HasSubstr("\n      variable 3 = 6 (was 5)\n"
                "      motor 1 actual_position: silent\n"));
  EXPECT_THAT(session.stands(Kind::step, standing(3), {{watched[0], 6}}),
              HasSubstr("\n      variable 3 = 6\n"));
  EXPECT_EQ(session.say("unwatch 3").text, "variable 3 is not shown any more\n");
  EXPECT_EQ(session.to_read(Kind::step).size(), 1U);
}

TEST(ProgramDebugger, VariablesAreThoseThatTheProgramNames) {
  auto session = debugger();
  session.say("watch 0 actual_position");
  session.say("watch 3");
  EXPECT_THAT(session.to_read(Kind::read),
              ElementsAre(Watched{{}, "3"}, Watched{{}, "7"}, Watched{0, "actual_position"}));
  EXPECT_EQ(session.stands(Kind::read, standing(1), {{{{}, "3"}, 1}, {{{}, "7"}, 2}}),
            "      variable 3 = 1\n      variable 7 = 2\n");
}

TEST(ProgramDebugger, EveryCommandThatNamesVariablesIsKnown) {
  const std::vector<std::pair<std::string, std::vector<std::uint8_t>>> programs{
      {"AGP 9, 2", {9}},       {"AGP 9, 0", {}},
      {"STGP 4, 2", {4}},      {"CALCVV ADD, 1, 2", {1, 2}},
      {"CALCVA ADD, 5", {5}},  {"CALCAV ADD, 6", {6}},
      {"CALCVX LOAD, 7", {7}}, {"CALCXV LOAD, 8", {8}},
      {"DJNZ 11, 0", {11}},
  };
  for (const auto& [line, variables] : programs) {
    const auto read = [&](const std::string&) -> tl::expected<std::string, std::string> {
      return line;
    };
    const auto assembly = assemble("one.tmc", read);
    ASSERT_TRUE(assembly) << line << describe(assembly.error().front());
    EXPECT_EQ(ProgramMap(*assembly).variables(), variables) << line;
  }
}

TEST(ProgramDebugger, ASimulatedModuleTellsItsRegisters) {
  auto session = debugger(true);
  EXPECT_EQ(session.say("registers").text, "not known yet\n");
  auto now = standing(1);
  now.registers = Registers{};
  now.time_s = 0.0003;
  EXPECT_EQ(session.stands(Kind::step, now, {}),
            "0.0003 s       1  Loop         count.tmc:3  Loop:   CALCV ADD, 3, 1\n");
  now.registers->accumulator = -4;
  now.registers->zero = false;
  now.registers->returns = {2, 0};
  now.address = 2;
  EXPECT_THAT(session.stands(Kind::step, now, {}),
              HasSubstr("\n      accumulator: 0 -> -4\n      zero: yes -> no\n"
                        "      stack: none -> Loop+1 0\n"));
  EXPECT_EQ(session.say("registers").text,
            "      accumulator  -4\n      X            0\n      zero         no\n"
            "      compared     equal\n      errors       none\n      stack        Loop+1 0\n"
            "      interrupted  no\n");
  EXPECT_EQ(session.say("back 3").kind, Kind::back);
  EXPECT_EQ(session.say("").steps, 3U);
}

TEST(ProgramDebugger, ListsTheTextAroundTheNextCommand) {
  auto session = debugger();
  session.say("break Loop");
  session.stands(Kind::step, standing(2), {});
  EXPECT_EQ(session.say("list").text,
            "           1  // counts\n"
            "           2  #include setup.inc\n"
            "     0     1  SGP 7, 2, 1\n"
            " *   1     3  Loop:   CALCV ADD, 3, 1\n"
            ">    2     4          GGP 3, 2\n"
            "     3     5          COMP 5\n"
            "     4     6          JC LT, Loop  // again\n"
            "     5     7  Done:   STOP\n");
}

TEST(ProgramDebugger, HelpNamesEveryCommand) {
  const auto help = debugger().say("help").text;
  for (const auto* name : {"step", "break", "continue", "delete", "list", "registers", "variables",
                           "watch", "unwatch", "quit", "help", "back", "where", "restart", "stop"})
    EXPECT_THAT(help, HasSubstr(std::string("\n") + name)) << name;
}

}  // namespace
}  // namespace tmcl::program

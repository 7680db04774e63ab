// Mint programs: those of application note AN00115-001 as they are printed, every form of a
// statement, and what is said of texts that are wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "support/random.hpp"
#include "support/seed.hpp"
#include "tmcl/plan/mint.hpp"

namespace tmcl::plan::mint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Program program_of(std::string_view text) {
  auto program = read(text);
  EXPECT_TRUE(program) << describe(program.error().front(), "text");
  return program.value_or(Program{});
}

TextProblems problems_of(std::string_view text) {
  const auto program = read(text);
  EXPECT_FALSE(program) << text;
  return program ? TextProblems{{}} : program.error();
}

/// "line:column: message" of the first.
std::string complaint(std::string_view text) { return describe(problems_of(text).front(), "text"); }

DryRun ran(std::string_view text, const Positions& start = {}) {
  auto run = dry_run(program_of(text), start);
  EXPECT_TRUE(run) << describe(run.error().front(), "text");
  return run.value_or(DryRun{});
}

std::string objection(std::string_view text) {
  const auto run = dry_run(program_of(text));
  EXPECT_FALSE(run);
  return run ? "" : describe(run.error().front(), "text");
}

constexpr std::string_view exercise =
    "SCALE = 1200\n"
    "SPEED = 250\n"
    "ACCEL = 1250\n"
    "DECEL = 1250\n"
    "MOVER = 200\n"
    "GO\n";

TEST(PlanMint, TheExerciseOfTheNote) {
  const auto program = program_of(exercise);
  ASSERT_THAT(program, SizeIs(6));
  EXPECT_EQ(program[0], (Statement{Keyword::scale, 1, 1, {{0, 1200}}, {}}));
  EXPECT_EQ(program[4], (Statement{Keyword::mover, 5, 1, {{0, 200}}, {}}));
  EXPECT_EQ(program[5], (Statement{Keyword::go, 6, 1, {}, {}}));

  const auto run = ran(exercise);
  ASSERT_THAT(run.groups, SizeIs(1));
  ASSERT_THAT(run.groups[0].moves, SizeIs(1));
  const auto& move = run.groups[0].moves[0];
  EXPECT_EQ(move.end, 200);
  EXPECT_EQ(move.scale, 1200);
  ASSERT_TRUE(move.profile);
  EXPECT_NEAR(move.profile->acceleration_time, 0.2, 1e-12);
  EXPECT_NEAR(move.profile->slew_time, 0.6, 1e-12);
  EXPECT_NEAR(move.profile->total_time, 1, 1e-12);
  EXPECT_NEAR(run.duration, 1, 1e-12);
  EXPECT_EQ(run.end[0], 200);
  EXPECT_THAT(run.warnings, IsEmpty());
}

TEST(PlanMint, TheFirstExampleWithItsEmptyLines) {
  const auto run = ran("SPEED = 8  \nACCEL = 16\n\nDECEL = 16\n\nMOVER = 12\n\nGO\n");
  ASSERT_THAT(run.groups, SizeIs(1));
  EXPECT_EQ(run.groups[0].line, 8U);
  EXPECT_NEAR(run.groups[0].duration, 2, 1e-12);
}

// The note says 600 ms, having computed with 12 units.
TEST(PlanMint, TheSecondExampleTakesLongerThanTheNoteSays) {
  const auto run = ran("SPEED = 30  \nACCEL = 150  \nDECEL = 150  \nMOVER = 20  \nGO");
  EXPECT_NEAR(run.duration, 0.8666666666666667, 1e-12);
}

TEST(PlanMint, EveryWayToNameAxes) {
  EXPECT_THAT(program_of("SPEED = 10, 20")[0].values,
              ElementsAre(AxisValue{0, 10}, AxisValue{1, 20}));
  EXPECT_THAT(program_of("speed.2=10")[0].values, ElementsAre(AxisValue{2, 10}));
  EXPECT_THAT(program_of("Speed(2) = 1e1")[0].values, ElementsAre(AxisValue{2, 10}));
  EXPECT_THAT(program_of("MOVEA[2, 0] = -10,+.5")[0].values,
              ElementsAre(AxisValue{2, -10}, AxisValue{0, 0.5}));
  EXPECT_THAT(program_of("MOVER[0,1] = 10;")[0].values,
              ElementsAre(AxisValue{0, 10}, AxisValue{1, 10}));
  EXPECT_THAT(program_of("MOVER[0,1,5] = 10, 7;")[0].values,
              ElementsAre(AxisValue{0, 10}, AxisValue{1, 7}, AxisValue{5, 7}));
  EXPECT_THAT(program_of("SPEED = 10;")[0].values, SizeIs(most_axes));
  EXPECT_THAT(program_of("GO[1,0]")[0].axes, ElementsAre(1, 0));
  EXPECT_THAT(program_of("GO.3")[0].axes, ElementsAre(3));
  EXPECT_THAT(program_of("GO (3)")[0].axes, ElementsAre(3));
}

TEST(PlanMint, CommentsSeparatorsAndLineEnds) {
  const auto program = program_of(
      "' nothing\r\n  REM SPEED = nonsense\r\n: SPEED = 1 : ACCEL = 2 ' here\r\nrem\r\n\t "
      "GO'x\r\n");
  ASSERT_THAT(program, SizeIs(3));
  EXPECT_EQ(program[0].line, 3U);
  EXPECT_EQ(program[0].column, 3U);
  EXPECT_EQ(program[1].column, 15U);
  EXPECT_EQ(program[2].line, 5U);
  EXPECT_EQ(program_of("SPEED = 1 : REM : SPEED = 2").size(), 1U);
  EXPECT_THAT(program_of(""), IsEmpty());
}

TEST(PlanMint, WhatIsWrongHasAPlace) {
  EXPECT_THAT(complaint("SPED = 1"), HasSubstr("text:1:1: 'SPED' is none of SCALE"));
  EXPECT_THAT(complaint("SPED = 1"), HasSubstr("Did you mean 'SPEED'?"));
  EXPECT_THAT(complaint("GO\n\n  JOG = 1"), HasSubstr("text:3:3: 'JOG'"));
  EXPECT_EQ(complaint("= 1"), "text:1:1: a keyword must stand here, not '='");
  EXPECT_EQ(complaint("SPEED 1"), "text:1:7: '=' is missing after SPEED");
  EXPECT_EQ(complaint("SPEED ="), "text:1:8: a number is missing");
  EXPECT_EQ(complaint("SPEED = ' 1"), "text:1:9: a number is missing");
  EXPECT_EQ(complaint("SPEED = x+1"), "text:1:9: 'x+1' is no number");
  EXPECT_EQ(complaint("SPEED = nan"), "text:1:9: 'nan' is no number");
  EXPECT_EQ(complaint("SPEED = -inf"), "text:1:9: '-inf' is no number");
  EXPECT_EQ(complaint("SPEED = 1e999"), "text:1:9: '1e999' is no number");
  EXPECT_EQ(complaint("SPEED = 1 2"), "text:1:11: '2' is too much here");
  EXPECT_EQ(complaint("SPEED = 0"), "text:1:9: SPEED must be above 0");
  EXPECT_EQ(complaint("DECEL = -1"), "text:1:9: DECEL must be above 0");
  EXPECT_EQ(complaint("SPEED = 1,,2"), "text:1:11: ',' is no number");
  EXPECT_EQ(complaint("SPEED.8 = 1"), "text:1:7: there is no axis 8; they are 0 to 7");
  EXPECT_EQ(complaint("SPEED.99999999999999999999 = 1"),
            "text:1:7: there is no axis 99999999999999999999; they are 0 to 7");
  EXPECT_EQ(complaint("SPEED. = 1"), "text:1:8: the number of an axis is missing");
  EXPECT_EQ(complaint("SPEED[0,0] = 1,1"), "text:1:9: axis 0 is named twice");
  EXPECT_EQ(complaint("SPEED[0,1 = 1"), "text:1:11: ']' is missing");
  EXPECT_EQ(complaint("SPEED[0) = 1"), "text:1:8: ']' is missing");
  EXPECT_THAT(complaint("SPEED[0,1] = 1"), HasSubstr("1 value for 2 axes; ';' after"));
  EXPECT_THAT(complaint("SPEED[0] = 1,2"), HasSubstr("2 values for 1 axis"));
  EXPECT_THAT(complaint("MOVER = 1;"), HasSubstr("which axes?"));
  EXPECT_THAT(complaint("GO = 1"), HasSubstr("'=' is too much here"));
  EXPECT_THAT(complaint("SPEED = 1,2,3,4,5,6,7,8,9"), HasSubstr("8 axes at most"));
}

TEST(PlanMint, AllProblemsAreToldUpToABound) {
  EXPECT_THAT(problems_of("A\nSPEED = 1\nB\n"), SizeIs(2));
  std::string many;
  for (int i = 0; i < 100; ++i) many += "A\n";
  EXPECT_THAT(problems_of(many), SizeIs(most_text_problems));
}

TEST(PlanMint, LinesAndTheirNumberAreBounded) {
  EXPECT_THAT(complaint("GO '" + std::string(most_text_line_bytes, 'x')), HasSubstr("too long"));
  EXPECT_THAT(complaint(std::string(most_text_lines + 1, '\n')), HasSubstr("too many lines"));
}

TEST(PlanMint, StatementsAreBounded) {
  std::string text;
  for (std::size_t statement = 0; statement < most_statements; ++statement) text += "SPEED=1\n";
  EXPECT_TRUE(read(text));
  EXPECT_THAT(complaint(text + "SPEED=1:GO\n"), HasSubstr("100000 statements at most"));
}

TEST(PlanMint, MovesAreLoadedAndThenGoTogether) {
  const auto run = ran(
      "SPEED = 10;\nACCEL = 100;\nMOVER[0,1] = 10, 20\nGO[1]\nGO[0]\nMOVEA[0,1] = 0; : GO[0,1]\n");
  ASSERT_THAT(run.groups, SizeIs(3));
  EXPECT_THAT(run.groups[0].moves, SizeIs(1));
  EXPECT_EQ(run.groups[0].moves[0].axis, 1U);
  EXPECT_EQ(run.groups[0].moves[0].line, 3U);
  EXPECT_EQ(run.groups[1].start_time, 0);
  // Both axes have to stand still.
  EXPECT_DOUBLE_EQ(run.groups[2].start_time, run.groups[0].duration);
  EXPECT_EQ(run.groups[2].moves[0].start, 10);
  EXPECT_EQ(run.groups[2].moves[1].start, 20);
  EXPECT_EQ(run.end[1], 0);
  EXPECT_DOUBLE_EQ(run.duration, 2 * run.groups[0].duration);
}

TEST(PlanMint, AShortMoveIsATriangle) {
  const auto run = ran("SPEED = 100 : ACCEL = 10 : DECEL = 10 : MOVER = -10 : GO");
  const auto& profile = run.groups[0].moves[0].profile;
  ASSERT_TRUE(profile);
  EXPECT_EQ(profile->slew_time, 0);
  EXPECT_DOUBLE_EQ(profile->speed, 10);
  EXPECT_EQ(run.end[0], -10);
}

TEST(PlanMint, WithoutDecelBothRampsAreAccel) {
  const auto run = ran("SPEED = 8 : ACCEL = 16 : MOVER = 12 : GO");
  EXPECT_EQ(run.groups[0].moves[0].profile->deceleration, 16);
}

TEST(PlanMint, AnotherScaleCountsTheSamePlaceDifferently) {
  const auto run = ran(
      "SPEED = 8 : ACCEL = 16 : SCALE = 100 : MOVEA = 3 : GO : SCALE = 10 : MOVER = 5 : GO", {200});
  EXPECT_EQ(run.groups[0].moves[0].start, 2);
  EXPECT_EQ(run.groups[1].moves[0].start, 30);
  EXPECT_EQ(run.end[0], 35);
}

TEST(PlanMint, WhereItStandsAlreadyNothingMoves) {
  const auto run = ran("MOVEA = 0 : GO");
  EXPECT_FALSE(run.groups[0].moves[0].profile);
  EXPECT_EQ(run.duration, 0);
}

TEST(PlanMint, WhatCannotBeRun) {
  EXPECT_EQ(objection("MOVER = 1 : GO"), "text:1:13: axis 0 has no SPEED");
  EXPECT_EQ(objection("SPEED = 1 : MOVER = 1 : GO"), "text:1:25: axis 0 has no ACCEL");
  EXPECT_EQ(objection("GO"), "text:1:1: no axis has a move loaded");
  EXPECT_EQ(objection("GO.1"), "text:1:1: axis 1 has no move loaded");
  EXPECT_EQ(objection("MOVER = 1\nMOVEA = 2"),
            "text:2:1: axis 0 has a move loaded already, on line 1; GO starts it");
  EXPECT_EQ(objection("SCALE = 1e200 : MOVER = 1e200 : GO"),
            "text:1:33: axis 0 would go beyond all numbers");
  EXPECT_THAT(objection("SPEED = 1e300 : ACCEL = 1e-300 : MOVER = 1e300 : GO"),
              HasSubstr("axis 0: "));
}

TEST(PlanMint, AMoveThatNeverStartsIsAWarning) {
  const auto run = ran("SPEED = 1;\nMOVER.2 = 5\n");
  ASSERT_THAT(run.warnings, SizeIs(1));
  EXPECT_EQ(describe(run.warnings[0], "text"), "text:2: no GO starts the move of axis 2");
}

// Whatever is read: it ends, and problems have places in the text.
TEST(PlanMint, SurvivesAnyText) {
  static constexpr std::string_view pieces[] = {"SPEED",
                                                "ACCEL",
                                                "DECEL",
                                                "SCALE",
                                                "MOVER",
                                                "MOVEA",
                                                "GO",
                                                "=",
                                                "[",
                                                "]",
                                                "(",
                                                ")",
                                                ".",
                                                ",",
                                                ";",
                                                ":",
                                                "'",
                                                "REM ",
                                                "\n",
                                                "\r\n",
                                                " ",
                                                "1",
                                                "0",
                                                "7",
                                                "-",
                                                "+",
                                                "e",
                                                "9e99",
                                                "\xff",
                                                "\t",
                                                "GO\n",
                                                "SPEED = 5;\nACCEL = 5;\n",
                                                "MOVER[0,1] = 4, 5\nGO\n"};
  test::Random<> random(test::seed());
  int good = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text;
    for (auto n = random.any_size(40); n > 0; --n)
      text += pieces[random.between(0, std::size(pieces) - 1)];
    const auto program = read(text);
    if (!program) {
      for (const auto& problem : program.error()) {
        ASSERT_GE(problem.line, 1U) << text;
        ASSERT_LE(problem.column, text.size() + 1) << text;
      }
      continue;
    }
    const auto run = dry_run(*program);
    good += run ? 1 : 0;
  }
  EXPECT_GT(good, 100);
}

}  // namespace
}  // namespace tmcl::plan::mint
